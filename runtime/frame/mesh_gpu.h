// Private to the renderer: meshes in GL buffers, with their UVs turned into tile coordinates.
#pragma once

#include "runtime/gl/gl_objects.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// A buffer that stands in for the texture coordinates or colours that a mesh does not have: one element that
// all vertices read.
GlBuffer makeDefaultAttributes();

struct GpuMesh {
  GlBuffer vertices, indices;
  GlBuffer uv_sets01, uv_sets23, colors;  // empty if the mesh has none
  GlVertexArray array;
  int index_count = 0;
};

// A mesh in GL buffers. Vertex attribute locations: 0 position, 1 normal, 2 tangent, 3 x (tile coordinates),
// 4 and 5 two sets of texture coordinates each, 6 colour. x = rotation(scale * uv) minus a whole number of
// periods near the mesh's own values, computed in double precision, so that huge UV offsets lose no
// precision. Tangents point along increasing x.x.
GpuMesh uploadMesh(const Mesh& mesh, const FlatBtfBinding& binding, const GlBuffer& defaults);
// Replaces the positions, normals and tangents of a mesh that was uploaded.
void moveVertices(const Mesh& mesh, const FlatBtfBinding& binding, const GpuMesh& gpu);

}  // namespace loden::runtime
