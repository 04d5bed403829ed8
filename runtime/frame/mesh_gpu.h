// Private to the renderer: meshes in GL buffers, with their UVs turned into tile coordinates.
#pragma once

#include "runtime/gl/gl_objects.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

struct GpuMesh {
  GlBuffer vertices, indices;
  GlVertexArray array;
  int index_count = 0;
};

// Locations 0 position, 1 normal, 2 tangent, 3 x. x = rotation(scale * uv) less a whole number of periods
// near the mesh's own, in double precision, so that huge UV offsets cost nothing; tangents run along x.x.
GpuMesh uploadMesh(const Mesh& mesh, const FlatBtfBinding& binding);

}  // namespace loden::runtime
