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

// Two sets of texture coordinates side by side; nothing if the mesh has neither.
GlBuffer uploadUvPair(const Mesh& mesh, size_t first) {
  const auto &a = mesh.uv_sets[first], &b = mesh.uv_sets[first + 1];
  if (a.empty() && b.empty()) return {};
  std::vector<glm::vec4> pairs(mesh.vertices.size(), glm::vec4(0));
  for (size_t i = 0; i < a.size(); ++i) pairs[i] = {a[i], 0, 0};
  for (size_t i = 0; i < b.size(); ++i) pairs[i].z = b[i].x, pairs[i].w = b[i].y;
  const auto bytes = std::as_bytes(std::span(pairs));
  return makeBuffer(bytes.size(), bytes, 0, mesh.name + " texture coordinates");
}

GlBuffer uploadColors(const Mesh& mesh) {
  if (mesh.colors.empty()) return {};
  std::vector<glm::u16vec4> codes;
  codes.reserve(mesh.colors.size());
  for (const glm::vec4& color : mesh.colors) codes.emplace_back(color * 65535.0f + 0.5f);
  const auto bytes = std::as_bytes(std::span(codes));
  return makeBuffer(bytes.size(), bytes, 0, mesh.name + " colours");
}

// An attribute with a buffer of its own, or the same value for all vertices.
void addStream(GLuint array, GLuint location, const GlBuffer& stream, GLsizei stride, GLenum type,
               const GlBuffer& defaults, size_t default_offset) {
  const GLuint binding = location;
  if (stream)
    glVertexArrayVertexBuffer(array, binding, stream.name(), 0, stride);
  else
    glVertexArrayVertexBuffer(array, binding, defaults.name(), GLintptr(default_offset), 0);
  glEnableVertexArrayAttrib(array, location);
  glVertexArrayAttribFormat(array, location, 4, type, type != GL_FLOAT, 0);
  glVertexArrayAttribBinding(array, location, binding);
}

struct DefaultAttributes {
  glm::vec4 uv{0};
  glm::u16vec4 color{65535};
};

}  // namespace

GlBuffer makeDefaultAttributes() {
  const DefaultAttributes defaults;
  return makeBuffer(sizeof defaults, std::as_bytes(std::span(&defaults, 1)), 0, "default attributes");
}

GpuMesh uploadMesh(const Mesh& mesh, const FlatBtfBinding& binding, const GlBuffer& defaults) {
  const std::vector<GpuVertex> vertices = gpuVertices(mesh, binding);
  const auto vertex_bytes = std::as_bytes(std::span(vertices));
  const auto index_bytes = std::as_bytes(std::span(mesh.indices));
  GpuMesh gpu;
  gpu.index_count = static_cast<int>(mesh.indices.size());
  gpu.vertices =
      makeBuffer(vertex_bytes.size(), vertex_bytes, GL_DYNAMIC_STORAGE_BIT, mesh.name + " vertices");
  gpu.indices = makeBuffer(index_bytes.size(), index_bytes, 0, mesh.name + " indices");
  gpu.array = makeVertexArray(mesh.name);
  const GLuint array = gpu.array.name();
  glVertexArrayVertexBuffer(array, 0, gpu.vertices.name(), 0, sizeof(GpuVertex));
  glVertexArrayElementBuffer(array, gpu.indices.name());
  addAttribute(array, 0, 3, offsetof(GpuVertex, position));
  addAttribute(array, 1, 3, offsetof(GpuVertex, normal));
  addAttribute(array, 2, 4, offsetof(GpuVertex, tangent));
  addAttribute(array, 3, 2, offsetof(GpuVertex, x));
  gpu.uv_sets01 = uploadUvPair(mesh, 0);
  gpu.uv_sets23 = uploadUvPair(mesh, 2);
  gpu.colors = uploadColors(mesh);
  addStream(array, 4, gpu.uv_sets01, sizeof(glm::vec4), GL_FLOAT, defaults, offsetof(DefaultAttributes, uv));
  addStream(array, 5, gpu.uv_sets23, sizeof(glm::vec4), GL_FLOAT, defaults, offsetof(DefaultAttributes, uv));
  addStream(array, 6, gpu.colors, sizeof(glm::u16vec4), GL_UNSIGNED_SHORT, defaults,
            offsetof(DefaultAttributes, color));
  return gpu;
}

void moveVertices(const Mesh& mesh, const FlatBtfBinding& binding, const GpuMesh& gpu) {
  const std::vector<GpuVertex> vertices = gpuVertices(mesh, binding);
  glNamedBufferSubData(gpu.vertices.name(), 0, GLsizeiptr(vertices.size() * sizeof(GpuVertex)),
                       vertices.data());
}

}  // namespace loden::runtime
