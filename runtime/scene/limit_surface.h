// Smooth meshes from coarse cages: points on the Catmull-Clark limit surface (by OpenSubdiv).
#pragma once

#include <string>

#include "material/base/result.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

inline constexpr int kMaxLimitLevels = 6;

// The limit surface of a quad cage; each cage quad becomes a grid of 2^levels x 2^levels quads of two
// triangles.
//
// Cage: every two consecutive triangles (a b c), (a c d) are the quad a b c d. Vertices at the same position
// are one vertex of the cage, whatever their UVs; open borders stay sharp.
//
// Result: positions, and normals and tangents from the analytic derivatives of the limit (no finite
// differences). UVs are limits of a face-varying channel: smooth inside a UV chart, linear along its border.
// Points shared by quads have bit-equal positions, so that there are no cracks.
//
// Issues: kGltfExtension (at `place`) if the cage does not consist of quads, or is not a manifold.
Result<Mesh> limitSurface(const Mesh& cage, int levels, const std::string& place);

}  // namespace loden::runtime
