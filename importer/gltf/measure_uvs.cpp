#include "importer/gltf/measure_uvs.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <map>
#include <utility>

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t kTriangles = 4, kStrip = 5, kFan = 6;

// Greatest value of an integer component, by which normalized ones are divided.
double greatestOf(int component_type) {
  switch (component_type) {
    case 5120:
      return 127;
    case 5121:
      return 255;
    case 5122:
      return 32767;
    case 5123:
      return 65535;
    default:
      return 1;
  }
}

class Surveyor {
 public:
  Surveyor(const Json& scene, GltfBuffers& buffers, int64_t material, int tex_coord)
      : json_(scene), buffers_(buffers), material_(material) {
    uv_name_ = "TEXCOORD_" + std::to_string(tex_coord);
  }

  UvSurvey run() {
    placeNodes();
    for (const auto& [node, world] : worlds_) {
      const Json& object = json_["nodes"][node];
      const int64_t mesh = integerMember(object, "mesh");
      if (exists(mesh, "meshes")) addMesh(json_["meshes"][size_t(mesh)], skinned(object, world));
    }
    return std::move(survey_);
  }

 private:
  bool exists(int64_t index, const char* list) const {
    return index >= 0 && static_cast<size_t>(index) < arraySize(json_, list);
  }

  static std::vector<double> numbers(const Json& object, const char* key, std::vector<double> otherwise) {
    std::vector<double> values;
    for (size_t i = 0; i < arraySize(object, key); ++i)
      if (object[key][i].is_number()) values.push_back(object[key][i].get<double>());
    return values.size() == otherwise.size() ? values : otherwise;
  }

  static glm::dmat4 matrixOf(const std::vector<double>& m) {
    glm::dmat4 matrix(1);
    for (int i = 0; i < 16; ++i) matrix[i / 4][i % 4] = m[size_t(i)];
    return matrix;
  }

  static glm::dmat4 localOf(const Json& node) {
    if (arraySize(node, "matrix") == 16) return matrixOf(numbers(node, "matrix", std::vector<double>(16, 0)));
    const auto t = numbers(node, "translation", {0, 0, 0}), r = numbers(node, "rotation", {0, 0, 0, 1}),
               s = numbers(node, "scale", {1, 1, 1});
    return glm::translate(glm::dmat4(1), {t[0], t[1], t[2]}) *
           glm::mat4_cast(glm::normalize(glm::dquat(r[3], r[0], r[1], r[2]))) *
           glm::scale(glm::dmat4(1), {s[0], s[1], s[2]});
  }

  // Each node is placed once, so that loops come to an end.
  void placeNodes() {
    std::vector<std::pair<int64_t, glm::dmat4>> open;
    const int64_t chosen = std::max<int64_t>(integerMember(json_, "scene"), 0);
    const auto push = [&](const Json& list, const glm::dmat4& world) {
      for (const Json& index : list)
        if (index.is_number_integer()) open.emplace_back(index.get<int64_t>(), world);
    };
    if (exists(chosen, "scenes"))
      if (const Json& scene = json_["scenes"][size_t(chosen)]; arraySize(scene, "nodes") > 0)
        push(scene["nodes"], glm::dmat4(1));
    while (!open.empty()) {
      const auto [node, parent] = open.back();
      open.pop_back();
      if (!exists(node, "nodes") || worlds_.contains(size_t(node))) continue;
      const Json& object = json_["nodes"][size_t(node)];
      const glm::dmat4 world = parent * localOf(object);
      worlds_[size_t(node)] = world;
      if (arraySize(object, "children") > 0) push(object["children"], world);
    }
  }

  // Where a node's mesh stands: a skin hangs on its joints alone, of which one tells the size.
  glm::dmat4 skinned(const Json& node, const glm::dmat4& world) {
    const int64_t index = integerMember(node, "skin");
    if (!exists(index, "skins")) return world;
    const Json& skin = json_["skins"][size_t(index)];
    if (arraySize(skin, "joints") == 0 || !skin["joints"][0].is_number_integer()) return world;
    const auto joint = worlds_.find(size_t(skin["joints"][0].get<int64_t>()));
    if (joint == worlds_.end()) return world;
    const std::vector<double> inverse = values(integerMember(skin, "inverseBindMatrices"), 16, 1);
    return inverse.size() >= 16 ? joint->second * matrixOf(inverse) : joint->second;
  }

  // The accessor's numbers, `components` of each element; none if it is not such an accessor.
  std::vector<double> values(int64_t accessor, int components, int64_t most = 1 << 24) {
    if (!exists(accessor, "accessors")) return {};
    const Json& object = json_["accessors"][size_t(accessor)];
    const auto shape = accessorShape(object);
    if (!shape || shape->components != components || (most > 1 && shape->count > most)) return {};
    const auto flag = object.find("normalized");
    const bool normalized = flag != object.end() && flag->is_boolean() && flag->get<bool>();
    const double unit = normalized ? 1 / greatestOf(shape->component_type) : 1;
    const bool stored = object.contains("bufferView") || object.contains("sparse");
    if (!stored || isCompressed(object)) return {};
    std::vector<double> result(size_t(shape->count) * size_t(components));
    const auto fault =
        visitAccessor(json_, buffers_, size_t(accessor), [&](uint64_t element, int component, double value) {
          result[element * uint64_t(components) + uint64_t(component)] = value * unit;
        });
    return fault ? std::vector<double>() : result;
  }

  bool isCompressed(const Json& accessor) const {
    const int64_t view = integerMember(accessor, "bufferView");
    if (!exists(view, "bufferViews")) return false;
    const Json& object = json_["bufferViews"][size_t(view)];
    return object.is_object() && object.contains("extensions") &&
           object["extensions"].contains("EXT_meshopt_compression");
  }

  void addMesh(const Json& mesh, const glm::dmat4& world) {
    for (size_t p = 0; p < arraySize(mesh, "primitives"); ++p) {
      const Json& primitive = mesh["primitives"][p];
      if (primitive.is_object() && integerMember(primitive, "material") == material_)
        addPrimitive(primitive, world);
    }
  }

  void addPrimitive(const Json& primitive, const glm::dmat4& world) {
    const int64_t mode = primitive.contains("mode") ? integerMember(primitive, "mode") : kTriangles;
    const auto attributes = primitive.find("attributes");
    if (mode < kTriangles || mode > kFan || attributes == primitive.end() || !attributes->is_object()) return;
    const std::vector<double> positions = values(integerMember(*attributes, "POSITION"), 3),
                              uvs = values(integerMember(*attributes, uv_name_.c_str()), 2);
    const size_t vertices = std::min(positions.size() / 3, uvs.size() / 2);
    std::vector<double> indices = values(integerMember(primitive, "indices"), 1);
    if (!primitive.contains("indices"))
      for (size_t i = 0; i < vertices; ++i) indices.push_back(double(i));
    const auto corner = [&](size_t k) { return size_t(indices[k]); };
    const auto add = [&](size_t a, size_t b, size_t c) {
      if (std::max({corner(a), corner(b), corner(c)}) >= vertices) return;
      std::array<glm::dvec3, 3> p;
      std::array<glm::dvec2, 3> t;
      for (int k = 0; const size_t at : {corner(a), corner(b), corner(c)}) {
        p[size_t(k)] = glm::dvec3(
            world * glm::dvec4(positions[3 * at], positions[3 * at + 1], positions[3 * at + 2], 1));
        t[size_t(k++)] = {uvs[2 * at], uvs[2 * at + 1]};
      }
      survey_.add(p, t);
    };
    if (mode == kTriangles)
      for (size_t i = 0; i + 2 < indices.size(); i += 3) add(i, i + 1, i + 2);
    else
      for (size_t i = 2; i < indices.size(); ++i) add(mode == kStrip ? i - 2 : 0, i - 1, i);
  }

  const Json& json_;
  GltfBuffers& buffers_;
  int64_t material_;
  std::string uv_name_;
  std::map<size_t, glm::dmat4> worlds_;  // of nodes in the scene
  UvSurvey survey_;
};

}  // namespace

UvSurvey surveyUvs(const Json& scene, GltfBuffers& buffers, int64_t material, int tex_coord) {
  return Surveyor(scene, buffers, material, tex_coord).run();
}

}  // namespace loden::importer
