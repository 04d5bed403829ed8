#include "runtime/frame/mesh_gpu.h"

#include <epoxy/gl.h>

#include <cmath>
#include <cstddef>
#include <span>

namespace loden::runtime {
namespace {

struct GpuVertex {
  glm::vec3 position, normal;
  glm::vec4 tangent;
  glm::vec2 x;
};

glm::dmat2 xFromUv(const FlatBtfBinding& binding) {
  const double c = std::cos(double(binding.rotation)), s = std::sin(double(binding.rotation));
  const glm::dmat2 rotation(c, s, -s, c);  // columns
  return rotation * glm::dmat2(binding.scale.x, 0, 0, binding.scale.y);
}

// Tangent along x.x from the one along u, for UVs that stretch u and v alike.
glm::vec4 tangentAlongX(const Vertex& vertex, const glm::dmat2& uv_from_x) {
  if (vertex.tangent.w == 0) return vertex.tangent;
  const glm::vec3 u(vertex.tangent), v = vertex.tangent.w * glm::cross(vertex.normal, u);
  const glm::vec3 along = u * static_cast<float>(uv_from_x[0][0]) + v * static_cast<float>(uv_from_x[0][1]);
  const float sign = glm::determinant(uv_from_x) < 0 ? -1.0f : 1.0f;
  return {glm::normalize(along), vertex.tangent.w * sign};
}

std::vector<GpuVertex> gpuVertices(const Mesh& mesh, const FlatBtfBinding& binding) {
  const glm::dmat2 x_from_uv = xFromUv(binding), uv_from_x = glm::inverse(x_from_uv);
  glm::dvec2 centre(0);
  for (const Vertex& vertex : mesh.vertices) centre += glm::dvec2(vertex.uv) / double(mesh.vertices.size());
  const glm::dvec2 offset = glm::floor(x_from_uv * centre);
  std::vector<GpuVertex> vertices;
  vertices.reserve(mesh.vertices.size());
  for (const Vertex& vertex : mesh.vertices)
    vertices.push_back({vertex.position, vertex.normal, tangentAlongX(vertex, uv_from_x),
                        glm::vec2(x_from_uv * glm::dvec2(vertex.uv) - offset)});
  return vertices;
}

void addAttribute(GLuint array, GLuint location, int components, size_t offset) {
  glEnableVertexArrayAttrib(array, location);
  glVertexArrayAttribFormat(array, location, components, GL_FLOAT, GL_FALSE, GLuint(offset));
  glVertexArrayAttribBinding(array, location, 0);
}

}  // namespace

GpuMesh uploadMesh(const Mesh& mesh, const FlatBtfBinding& binding) {
  const std::vector<GpuVertex> vertices = gpuVertices(mesh, binding);
  const auto vertex_bytes = std::as_bytes(std::span(vertices));
  const auto index_bytes = std::as_bytes(std::span(mesh.indices));
  GpuMesh gpu;
  gpu.index_count = static_cast<int>(mesh.indices.size());
  gpu.vertices = makeBuffer(vertex_bytes.size(), vertex_bytes, 0, mesh.name + " vertices");
  gpu.indices = makeBuffer(index_bytes.size(), index_bytes, 0, mesh.name + " indices");
  gpu.array = makeVertexArray(mesh.name);
  const GLuint array = gpu.array.name();
  glVertexArrayVertexBuffer(array, 0, gpu.vertices.name(), 0, sizeof(GpuVertex));
  glVertexArrayElementBuffer(array, gpu.indices.name());
  addAttribute(array, 0, 3, offsetof(GpuVertex, position));
  addAttribute(array, 1, 3, offsetof(GpuVertex, normal));
  addAttribute(array, 2, 4, offsetof(GpuVertex, tangent));
  addAttribute(array, 3, 2, offsetof(GpuVertex, x));
  return gpu;
}

}  // namespace loden::runtime
