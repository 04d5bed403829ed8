// Normals and tangents for meshes that come without.
#include <cmath>
#include <unordered_map>

#include "runtime/scene/scene.h"

namespace loden::runtime {
namespace {

struct TriangleFrame {
  glm::vec3 tangent{0};  // dP/du times twice the UV area: large triangles weigh more
  float sign = 0;        // of the UV area; 0 if degenerate
};

TriangleFrame triangleFrame(const Vertex& a, const Vertex& b, const Vertex& c) {
  const glm::vec3 e1 = b.position - a.position, e2 = c.position - a.position;
  const glm::vec2 d1 = b.uv - a.uv, d2 = c.uv - a.uv;
  const float area = d1.x * d2.y - d2.x * d1.y;
  if (!(std::abs(area) > 1e-20f)) return {};
  const float sign = area > 0 ? 1.0f : -1.0f;
  return {sign * (e1 * d2.y - e2 * d1.y), sign};
}

// Gram-Schmidt against the normal; w = 0 if nothing is left.
glm::vec4 tangentAgainst(const glm::vec3& normal, const glm::vec3& sum, float sign) {
  const glm::vec3 t = sum - normal * glm::dot(normal, sum);
  const float length = glm::length(t);
  if (!(length > 1e-20f)) return {1, 0, 0, 0};
  return {t / length, sign};
}

// Keeps one copy of each vertex per sign of the UV area that its triangles have.
class SignSplitter {
 public:
  explicit SignSplitter(Mesh& mesh)
      : mesh_(mesh), signs_(mesh.vertices.size(), 0.0f), sums_(mesh.vertices.size(), glm::vec3(0)) {}

  // The index to use in a triangle with this frame; adds the frame to it.
  uint32_t add(uint32_t index, const TriangleFrame& frame) {
    if (frame.sign == 0) return index;
    const uint32_t target = copyWithSign(index, frame.sign);
    sums_[target] += frame.tangent;
    return target;
  }

  void store() {
    appendCopies(mesh_, copied_);
    for (size_t i = 0; i < mesh_.vertices.size(); ++i)
      mesh_.vertices[i].tangent = tangentAgainst(mesh_.vertices[i].normal, sums_[i], signs_[i]);
  }

 private:
  uint32_t copyWithSign(uint32_t index, float sign) {
    if (signs_[index] == 0) signs_[index] = sign;
    if (signs_[index] == sign) return index;
    const auto [it, fresh] = mirrored_.try_emplace(index, static_cast<uint32_t>(signs_.size()));
    if (fresh) {
      copied_.push_back(index);
      signs_.push_back(sign);
      sums_.push_back(glm::vec3(0));
    }
    return it->second;
  }

  Mesh& mesh_;
  std::vector<uint32_t> copied_;  // the vertices whose copies come behind the mesh's own
  std::vector<float> signs_;
  std::vector<glm::vec3> sums_;
  std::unordered_map<uint32_t, uint32_t> mirrored_;
};

}  // namespace

void computeNormals(Mesh& mesh) {
  for (Vertex& vertex : mesh.vertices) vertex.normal = glm::vec3(0);
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    Vertex* v[3] = {&mesh.vertices[mesh.indices[i]], &mesh.vertices[mesh.indices[i + 1]],
                    &mesh.vertices[mesh.indices[i + 2]]};
    const glm::vec3 area = glm::cross(v[1]->position - v[0]->position, v[2]->position - v[0]->position);
    for (Vertex* vertex : v) vertex->normal += area;
  }
  for (Vertex& vertex : mesh.vertices) {
    const float length = glm::length(vertex.normal);
    vertex.normal = length > 0 ? vertex.normal / length : glm::vec3(0, 1, 0);
  }
}

void computeTangents(Mesh& mesh) {
  SignSplitter splitter(mesh);
  for (size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
    uint32_t* index = &mesh.indices[i];
    const TriangleFrame frame =
        triangleFrame(mesh.vertices[index[0]], mesh.vertices[index[1]], mesh.vertices[index[2]]);
    for (int corner = 0; corner < 3; ++corner) index[corner] = splitter.add(index[corner], frame);
  }
  splitter.store();
}

}  // namespace loden::runtime
