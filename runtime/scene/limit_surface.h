// Smooth scene objects from coarse cages: points of the Catmull-Clark limit surface (OpenSubdiv).
#pragma once

#include <string>

#include "material/base/result.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

inline constexpr int kMaxLimitLevels = 6;

// The limit surface of a quad cage, each cage quad a grid of 2^levels x 2^levels quads of two triangles.
//   cage: each two triangles in a row (a b c), (a c d) are the quad a b c d. Vertices at the same position
//   are one vertex of the cage, whatever their UVs; open borders stay sharp. Result: positions, and normals
//   and tangents from the analytic derivatives of the limit (no finite differences). UVs are limits of a
//   face-varying channel: smooth inside a UV chart, linear along its border. Points shared by quads have
//   bit-equal positions, so there are no cracks.
// kGltfExtension (at `place`) if the cage is not made of quads, or is no manifold.
Result<Mesh> limitSurface(const Mesh& cage, int levels, const std::string& place);

}  // namespace loden::runtime
