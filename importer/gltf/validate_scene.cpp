// What of a scene the runtime would refuse, and glTF forbids: meshes, nodes and scenes.
#include <cmath>
#include <limits>
#include <map>

#include "importer/gltf/gltf_accessor.h"
#include "importer/gltf/validate.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t kTriangles = 4, kLastMode = 6;
constexpr int64_t kMostSubdivisions = 6;

std::string at(const char* list, size_t i) {
  return std::string(list) + "[" + std::to_string(i) + "]";
}

class SceneGraphCheck {
 public:
  SceneGraphCheck(const Json& scene, GltfBuffers& buffers, const std::string& file)
      : json_(scene), buffers_(buffers), file_(file) {}

  std::vector<Issue> run() {
    for (size_t m = 0; m < arraySize(json_, "meshes"); ++m) checkMesh(m);
    for (size_t n = 0; n < arraySize(json_, "nodes"); ++n) checkNode(n);
    checkTrees();
    checkScenes();
    return std::move(issues_);
  }

 private:
  void add(int id, const std::string& place, const std::string& text) {
    issues_.push_back({id, Severity::kError, file_ + ": " + place, text});
  }
  bool exists(int64_t index, const char* list) const {
    return index >= 0 && static_cast<size_t>(index) < arraySize(json_, list);
  }

  void checkMesh(size_t m) {
    const Json& mesh = json_["meshes"][m];
    for (size_t p = 0; p < arraySize(mesh, "primitives"); ++p)
      if (mesh["primitives"][p].is_object())
        checkPrimitive(mesh["primitives"][p], at("meshes", m) + "." + at("primitives", p));
    if (!mesh.is_object() || !mesh.contains("extras") || !mesh["extras"].is_object() ||
        !mesh["extras"].contains("loden_subdivision"))
      return;
    const Json& asked = mesh["extras"]["loden_subdivision"];
    const int64_t levels = integerMember(asked, "levels");
    if (levels < 1 || levels > kMostSubdivisions || !asked.contains("quads") || asked["quads"] != true)
      add(issue_id::kSubdivision, at("meshes", m) + ".extras.loden_subdivision",
          "needs \"levels\" 1 .. " + std::to_string(kMostSubdivisions) + " and \"quads\": true");
  }

  void checkPrimitive(const Json& primitive, const std::string& place) {
    const int64_t mode = primitive.contains("mode") ? integerMember(primitive, "mode") : kTriangles;
    if (mode < 0 || mode > kLastMode)
      return add(issue_id::kPrimitiveMode, place, "has a mode that is unknown");
    if (primitive.contains("material") && !exists(integerMember(primitive, "material"), "materials"))
      add(issue_id::kPrimitiveMaterial, place, "names no existing material");
    if (mode < kTriangles) return;  // points and lines are not drawn
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object() || !attributes->contains("POSITION"))
      return add(issue_id::kNoPosition, place, "has no attribute POSITION");
    const int64_t positions = integerMember(*attributes, "POSITION");
    if (!exists(positions, "accessors"))
      return add(issue_id::kAttributeAccessor, place + ".POSITION", "names no existing accessor");
    const auto shape = accessorShape(json_["accessors"][static_cast<size_t>(positions)]);
    if (!shape) return;  // said of the accessor
    for (const auto& [name, accessor] : attributes->items())
      checkAttribute(name, accessor, shape->count, place + "." + name);
    for (size_t t = 0; t < arraySize(primitive, "targets"); ++t)
      for (const auto& [name, accessor] : primitive["targets"][t].items())
        checkAttribute(name, accessor, shape->count, place + "." + at("targets", t) + "." + name, true);
    const int64_t corners = primitive.contains("indices")
                                ? checkIndices(primitive["indices"], shape->count, place + ".indices")
                                : shape->count;
    if (mode == kTriangles && corners % 3 != 0)
      add(issue_id::kTriangleCorners, place, "has triangles of a number of corners that is no multiple of 3");
  }

  // Components that glTF gives an attribute; 0 for attributes of other tools.
  static int wantedComponents(const std::string& name, int given, bool delta) {
    if (name == "POSITION" || name == "NORMAL") return 3;
    if (name == "TANGENT") return delta ? 3 : 4;
    if (name.starts_with("TEXCOORD_")) return 2;
    if (name.starts_with("COLOR_")) return given == 3 ? 3 : 4;
    if (name.starts_with("JOINTS_") || name.starts_with("WEIGHTS_")) return 4;
    return 0;
  }

  void checkAttribute(const std::string& name, const Json& index, int64_t vertices, const std::string& place,
                      bool delta = false) {
    const auto bad = [&](int id, const char* text) { add(id, place, text); };
    const int64_t accessor = index.is_number_integer() ? index.get<int64_t>() : -1;
    if (!exists(accessor, "accessors"))
      return bad(issue_id::kAttributeAccessor, "names no existing accessor");
    const auto shape = accessorShape(json_["accessors"][static_cast<size_t>(accessor)]);
    if (!shape) return;  // said of the accessor
    const int wanted = wantedComponents(name, shape->components, delta);
    if (wanted == 0) return;
    if (shape->components != wanted)
      return bad(issue_id::kAttributeComponents, "is of an accessor with another number of components");
    if (shape->component_type == 5125)
      return bad(issue_id::kAttributeIntegers, "is of an accessor of 32-bit integers");
    if (shape->count != vertices)
      bad(issue_id::kAttributeCount, "has not as many elements as there are positions");
    if (shape->component_type != 5126) return;
    if (!finite_.contains(accessor)) {
      bool finite = true;
      visitAccessor(json_, buffers_, static_cast<size_t>(accessor),
                    [&](uint64_t, int, double value) { finite = finite && std::isfinite(value); });
      finite_[accessor] = finite;
    }
    if (!finite_[accessor]) bad(issue_id::kAttributeFinite, "has numbers that are not finite");
  }

  // How many there are; 0 if that is not known.
  int64_t checkIndices(const Json& index, int64_t vertices, const std::string& place) {
    const int64_t accessor = index.is_number_integer() ? index.get<int64_t>() : -1;
    if (!exists(accessor, "accessors"))
      return add(issue_id::kIndexAccessor, place, "names no existing accessor"), 0;
    const auto shape = accessorShape(json_["accessors"][static_cast<size_t>(accessor)]);
    if (!shape) return 0;
    const int type = shape->component_type;
    if (shape->components != 1 || (type != 5121 && type != 5123 && type != 5125))
      return add(issue_id::kIndexType, place, "is of no accessor of unsigned integers"), 0;
    double greatest = 0;
    visitAccessor(json_, buffers_, static_cast<size_t>(accessor),
                  [&](uint64_t, int, double value) { greatest = std::max(greatest, value); });
    if (greatest >= static_cast<double>(vertices))
      add(issue_id::kIndexRange, place,
          "has the index " + std::to_string(static_cast<int64_t>(greatest)) + ", and there are " +
              std::to_string(vertices) + " vertices");
    return shape->count;
  }

  void checkNode(size_t n) {
    const Json& node = json_["nodes"][n];
    const std::string place = at("nodes", n);
    if (!node.is_object()) return add(issue_id::kGltfType, place, "must be an object");
    struct Reference {
      const char *member, *list;
      int id;
    };
    for (const Reference& r : {Reference{"mesh", "meshes", issue_id::kNodeMesh},
                               {"camera", "cameras", issue_id::kNodeCamera},
                               {"skin", "skins", issue_id::kNodeSkin}})
      if (node.contains(r.member) && !exists(integerMember(node, r.member), r.list))
        add(r.id, place, std::string("names no existing ") + r.member);
    for (const char* member : {"matrix", "translation", "rotation", "scale"})
      for (size_t k = 0; k < arraySize(node, member); ++k)
        if (!node[member][k].is_number() ||
            !(std::abs(node[member][k].get<double>()) <= double(std::numeric_limits<float>::max())))
          return add(issue_id::kNodeNumbers, place, std::string(member) + " is not of finite numbers");
    checkLight(node, place);
  }

  void checkLight(const Json& node, const std::string& place) {
    constexpr const char* kLights = "KHR_lights_punctual";
    if (!node.contains("extensions") || !node["extensions"].is_object() ||
        !node["extensions"].contains(kLights))
      return;
    const Json& root = json_.contains("extensions") ? json_["extensions"] : json_;
    const size_t lights = root.is_object() && root.contains(kLights) ? arraySize(root[kLights], "lights") : 0;
    const int64_t light = integerMember(node["extensions"][kLights], "light");
    if (light < 0 || static_cast<size_t>(light) >= lights)
      add(issue_id::kNodeLight, place + ".extensions." + kLights, "names no existing light");
  }

  // Every node has at most one parent, and none is its own ancestor.
  void checkTrees() {
    const size_t nodes = arraySize(json_, "nodes");
    parents_.assign(nodes, kNone);
    for (size_t n = 0; n < nodes; ++n)
      for (size_t k = 0; k < arraySize(json_["nodes"][n], "children"); ++k) {
        const Json& index = json_["nodes"][n]["children"][k];
        const int64_t child = index.is_number_integer() ? index.get<int64_t>() : -1;
        if (!exists(child, "nodes"))
          add(issue_id::kNodeChild, at("nodes", n) + "." + at("children", k), "names no existing node");
        else if (parents_[static_cast<size_t>(child)] != kNone)
          add(issue_id::kNodeParents, at("nodes", static_cast<size_t>(child)), "has two parents");
        else
          parents_[static_cast<size_t>(child)] = n;
      }
    std::vector<size_t> walk(nodes, kNone);  // the node whose way up came by here first
    for (size_t n = 0; n < nodes; ++n)
      for (size_t up = n; up != kNone && walk[up] != n; up = parents_[up]) {
        if (walk[up] != kNone) break;
        walk[up] = n;
        if (parents_[up] != kNone && walk[parents_[up]] == n)
          add(issue_id::kNodeLoop, at("nodes", parents_[up]), "is part of a loop");
      }
  }

  void checkScenes() {
    if (json_.contains("scene") && !exists(integerMember(json_, "scene"), "scenes"))
      add(issue_id::kSceneDefault, "scene", "names no existing scene");
    for (size_t s = 0; s < arraySize(json_, "scenes"); ++s) {
      std::vector<bool> met(arraySize(json_, "nodes"));
      for (size_t k = 0; k < arraySize(json_["scenes"][s], "nodes"); ++k) {
        const std::string place = at("scenes", s) + "." + at("nodes", k);
        const Json& index = json_["scenes"][s]["nodes"][k];
        const int64_t node = index.is_number_integer() ? index.get<int64_t>() : -1;
        if (!exists(node, "nodes")) {
          add(issue_id::kSceneNode, place, "names no existing node");
          continue;
        }
        if (parents_[static_cast<size_t>(node)] != kNone || met[static_cast<size_t>(node)])
          add(issue_id::kSceneRoot, place, "is no root, or stands there twice");
        met[static_cast<size_t>(node)] = true;
      }
    }
  }

  static constexpr size_t kNone = std::numeric_limits<size_t>::max();

  const Json& json_;
  GltfBuffers& buffers_;
  const std::string& file_;
  std::vector<Issue> issues_;
  std::map<int64_t, bool> finite_;  // [accessor]
  std::vector<size_t> parents_;     // [node]
};

}  // namespace

std::vector<Issue> checkSceneGraph(const Json& scene, GltfBuffers& buffers, const std::string& file) {
  return SceneGraphCheck(scene, buffers, file).run();
}

}  // namespace loden::importer
