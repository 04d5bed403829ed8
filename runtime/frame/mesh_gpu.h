// Private to the renderer: meshes in GL buffers, with their UVs turned into tile coordinates.
#pragma once

#include "runtime/gl/gl_objects.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// What meshes without texture coordinates or colours read instead: one element for all vertices.
GlBuffer makeDefaultAttributes();

struct GpuMesh {
  GlBuffer vertices, indices;
  GlBuffer uv_sets01, uv_sets23, colors;  // none if no vertex has any
  GlVertexArray array;
  int index_count = 0;
};

// Locations 0 position, 1 normal, 2 tangent, 3 x, 4 and 5 two texture coordinate sets each, 6 colour. x =
// rotation(scale * uv) less a whole number of periods near the mesh's own, in double precision, so that huge
// UV offsets cost nothing; tangents run along x.x.
GpuMesh uploadMesh(const Mesh& mesh, const FlatBtfBinding& binding, const GlBuffer& defaults);
// New positions, normals and tangents of the mesh that was uploaded.
void moveVertices(const Mesh& mesh, const FlatBtfBinding& binding, const GpuMesh& gpu);

}  // namespace loden::runtime
