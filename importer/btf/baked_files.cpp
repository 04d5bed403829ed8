#include "importer/btf/baked_files.h"

#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "material/base/issues.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;
constexpr const char* kSchema = "loden/bake/1";
constexpr int kMaxSide = 4096, kMaxDirections = 4096;
constexpr double kMostAspect = 8;  // importer/tile/tile.h

fs::path viewPath(const fs::path& folder, const char* kind, int view, const char* extension) {
  char name[48];
  std::snprintf(name, sizeof name, "view_%04d.%s", view, extension);
  return folder / kind / name;
}

nlohmann::ordered_json directionsJson(const DirectionSet& set) {
  if (set.kind != DirectionSetKind::kList) return directionsName(set);
  auto list = nlohmann::ordered_json::array();
  for (const glm::dvec3& w : set.samples) list.push_back({w.x, w.y, w.z});
  return list;
}

std::optional<DirectionSet> directionsFromJson(const nlohmann::json& json) {
  if (json.is_string()) return directionsByName(json.get<std::string>());
  DirectionSet set;
  for (const auto& w : json) {
    const glm::dvec3 direction(w.at(0).get<double>(), w.at(1).get<double>(), w.at(2).get<double>());
    if (std::abs(glm::length(direction) - 1) > 1e-3 || direction.z <= 0) return std::nullopt;
    set.samples.push_back(glm::normalize(direction));
  }
  return set;
}

}  // namespace

fs::path btfPath(const fs::path& folder, int view) {
  return viewPath(folder, "btf", view, "exr");
}
fs::path flatPath(const fs::path& folder, int view) {
  return viewPath(folder, "flat", view, "exr");
}
fs::path visiblePath(const fs::path& folder, int view) {
  return viewPath(folder, "visible", view, "png");
}
fs::path vdimPath(const fs::path& folder, glm::ivec2 size) {
  return folder / "vdim" / ("latlong_" + std::to_string(size.x) + "x" + std::to_string(size.y) + ".exr");
}
fs::path concentricVdimPath(const fs::path& folder, int directions) {
  return folder / "vdim" / ("concentric_" + std::to_string(directions) + ".exr");
}
fs::path surfacePath(const fs::path& folder, const std::string& map) {
  return folder / "surface" / (map + ".exr");
}

const char* fillName(FillMethod method) {
  switch (method) {
    case FillMethod::kHarmonic:
      return "harmonic";
    case FillMethod::kNearestView:
      return "nearest-view";
    default:
      return "push-pull";
  }
}

std::optional<FillMethod> fillByName(const std::string& name) {
  for (const FillMethod method : {FillMethod::kPushPull, FillMethod::kHarmonic, FillMethod::kNearestView})
    if (name == fillName(method)) return method;
  return std::nullopt;
}

AtlasLayout AtlasLayout::forLights(int side, int lights) {
  return {side, lights, static_cast<int>(std::ceil(std::sqrt(double(lights))))};
}

std::string manifestText(const BakeManifest& m) {
  nlohmann::ordered_json json;
  json["schema"] = kSchema;
  json["revision"] = m.revision;
  json["tile"] = m.tile;
  json["input_hash"] = m.input_hash;
  if (m.aspect != 1) json["aspect"] = m.aspect;
  if (m.period != 0) json["period"] = m.period;
  json["size"] = m.size;
  json["flat_size"] = m.flat_size;
  json["surface_size"] = m.surface_size;
  json["geometry_size"] = m.geometry_size;
  json["supersample"] = m.supersample;
  json["bounces"] = m.bounces;
  json["fill"] = fillName(m.fill);
  json["texels"] = m.texels == TexelMethod::kLinear ? "linear" : "mean";
  json["directions"] = directionsJson(m.directions);
  json["vdims"] = nlohmann::ordered_json::array();
  for (const glm::ivec2& size : m.vdims) json["vdims"].push_back({size.x, size.y});
  if (!m.concentric_vdims.empty()) json["concentric_vdims"] = m.concentric_vdims;
  json["maps"] = {{"btf", m.has_btf}, {"flat", m.has_flat}, {"vdim", m.has_vdim}, {"surface", m.has_surface}};
  json["lobe"] = m.has_ggx ? "ggx" : "phong";
  json["identity_parameterization"] = m.identity_parameterization;
  json["parameterization"] = {{"flipped_triangles", m.flipped_triangles},
                              {"area_cv", m.area_cv},
                              {"area_p5", m.area_p5},
                              {"area_p95", m.area_p95}};
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) +
         "\n";  // paths need not be UTF-8
}

Result<BakeManifest> parseManifest(const std::string& text, const std::string& where) {
  const auto refuse = [&](const std::string& why) {
    return Issue{issue_id::kBakeManifest, Severity::kError, where, why};
  };
  try {
    const auto json = nlohmann::json::parse(text);
    if (json.at("schema") != kSchema) return refuse(std::string("schema is not ") + kSchema);
    BakeManifest m;
    m.tile = json.at("tile").get<std::string>();
    m.input_hash = json.at("input_hash").get<std::string>();
    m.aspect = json.value("aspect", 1.0), m.period = json.value("period", 0.0);
    if (!(m.aspect >= 1 / kMostAspect && m.aspect <= kMostAspect)) return refuse("aspect is outside 1/8..8");
    if (!(m.period >= 0 && m.period < 1e6)) return refuse("period is not a length in metres");
    m.size = json.at("size").get<int>();
    m.flat_size = json.at("flat_size").get<int>();
    m.surface_size = json.value("surface_size", m.flat_size);  // revision 4 baked both alike
    m.geometry_size = json.at("geometry_size").get<int>();
    m.supersample = json.at("supersample").get<int>();
    m.revision = json.value("revision", 0);  // baked by other tools
    m.bounces = json.at("bounces").get<int>();
    const auto fill = fillByName(json.value("fill", "push-pull"));
    if (!fill) return refuse("fill is none of push-pull, harmonic, nearest-view");
    m.fill = *fill;
    if (const std::string texels = json.value("texels", "mean"); texels == "linear")
      m.texels = TexelMethod::kLinear;
    else if (texels != "mean")
      return refuse("texels is neither mean nor linear");
    for (const int side : {m.size, m.flat_size, m.surface_size, m.geometry_size})
      if (side < 1 || side > kMaxSide) return refuse("a size is outside 1.." + std::to_string(kMaxSide));
    const auto directions = directionsFromJson(json.at("directions"));
    if (!directions || directions->size() < 1 || directions->size() > kMaxDirections)
      return refuse("directions are not valid");
    m.directions = *directions;
    for (const auto& size : json.at("vdims"))
      m.vdims.push_back({size.at(0).get<int>(), size.at(1).get<int>()});
    m.concentric_vdims = json.value("concentric_vdims", std::vector<int>());
    for (const glm::ivec2& size : m.vdims)
      if (size.x < 2 || size.y < 2 || size.x > kMaxVdimSide || size.y > kMaxVdimSide)
        return refuse("a size in vdims is outside 2.." + std::to_string(kMaxVdimSide));
    for (const int side : m.concentric_vdims)
      if (side < 1 || side > kMaxVdimSide)
        return refuse("a size in concentric_vdims is outside 1.." + std::to_string(kMaxVdimSide));
    const auto& maps = json.at("maps");
    m.has_btf = maps.at("btf").get<bool>(), m.has_flat = maps.at("flat").get<bool>();
    m.has_vdim = maps.at("vdim").get<bool>(), m.has_surface = maps.at("surface").get<bool>();
    const std::string lobe = json.value("lobe", "phong");
    if (lobe != "phong" && lobe != "ggx") return refuse("lobe is neither phong nor ggx");
    m.has_ggx = lobe == "ggx";
    m.identity_parameterization = json.at("identity_parameterization").get<bool>();
    if (const auto quality = json.find("parameterization");
        quality != json.end()) {  // other tools may not know
      m.flipped_triangles = quality->at("flipped_triangles").get<int>();
      m.area_cv = quality->at("area_cv").get<double>();
      m.area_p5 = quality->at("area_p5").get<double>(), m.area_p95 = quality->at("area_p95").get<double>();
    }
    return m;
  } catch (const nlohmann::json::exception& error) {
    return refuse(std::string("not a bake manifest: ") + error.what());
  }
}

}  // namespace loden::importer
