// Small tiles and mesh files for the importer's tests.
#pragma once

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>
#include <string>

#include "importer/gltf/gltf_document.h"
#include "importer/tile/tile.h"
#include "material/model/directions.h"

namespace loden::importer::testing {

// A temporary folder that the destructor removes.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "loden_test_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() { std::filesystem::remove_all(path_); }
  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name, std::ios::binary) << text;
    return path_ / name;
  }

 private:
  std::filesystem::path path_;
};

// A tile with z = height(p) and one reflectance everywhere, as an n x n grid of two triangles per cell.
inline Tile heightFieldTile(int n, const std::function<double(glm::dvec2)>& height,
                            const LocalBrdf& brdf = {glm::vec3(1), 0, 1}) {
  Tile tile;
  tile.name = "test";
  tile.identity_parameterization = true;
  constexpr double kStep = 1e-5;
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const glm::dvec2 p = glm::dvec2(i, j) / double(n);
      const double dx = height(p + glm::dvec2(kStep, 0)) - height(p - glm::dvec2(kStep, 0));
      const double dy = height(p + glm::dvec2(0, kStep)) - height(p - glm::dvec2(0, kStep));
      tile.positions.push_back({p, height(p)});
      tile.normals.push_back(glm::normalize(glm::dvec3(-dx, -dy, 2 * kStep)));
      tile.params.push_back(p);
      tile.brdfs.push_back(brdf);
    }
  const auto row = static_cast<uint32_t>(n) + 1;
  for (uint32_t j = 0; j + 1 < row; ++j)
    for (uint32_t i = 0; i + 1 < row; ++i) {
      const uint32_t a = j * row + i;
      tile.triangles.push_back({a, a + 1, a + row + 1});
      tile.triangles.push_back({a, a + row + 1, a + row});
    }
  tile.charts.assign(tile.triangles.size(), 1);
  return tile;
}

inline Tile flatTile(const LocalBrdf& brdf = {glm::vec3(1), 0, 1}) {
  return heightFieldTile(
      2, [](glm::dvec2) { return 0.0; }, brdf);
}

// A tile with two grooves along y that are `depth` deep.
inline Tile groovedTile(double depth = 0.2) {
  return heightFieldTile(32, [depth](glm::dvec2 p) { return depth / 2 * (std::cos(4 * kPi * p.x) - 1); });
}

// OBJ text of an n x n grid of quads. `position` and `uv` are functions of the grid coordinate in [0,1]^2; uv
// may be empty.
inline std::string objGrid(int n, const std::function<glm::dvec3(glm::dvec2)>& position,
                           const std::function<glm::dvec2(glm::dvec2)>& uv) {
  std::ostringstream text;
  text.precision(17);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const glm::dvec2 q = glm::dvec2(i, j) / double(n);
      const glm::dvec3 p = position(q);
      text << "v " << p.x << ' ' << p.y << ' ' << p.z << '\n';
      if (uv) text << "vt " << uv(q).x << ' ' << uv(q).y << '\n';
    }
  const auto corner = [&](int i, int j) {
    const std::string index = std::to_string(j * (n + 1) + i + 1);
    return uv ? index + "/" + index : index;
  };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i)
      text << "f " << corner(i, j) << ' ' << corner(i + 1, j) << ' ' << corner(i + 1, j + 1) << ' '
           << corner(i, j + 1) << '\n';
  return text.str();
}

// glTF's JSON of a flat tile of 2 x 2 m, of two triangles in the xz plane. Tests change it and write it.
inline nlohmann::ordered_json gltfTile() {
  const float data[] = {0, 0, 0, 2, 0, 0, 2, 0, -2, 0, 0, -2,  // positions; -z is the tile's +y
                        0, 1, 1, 1, 1, 0, 0, 0};               // texture coordinates, v down
  const uint16_t indices[] = {0, 1, 2, 0, 2, 3};
  std::string bytes(sizeof data + sizeof indices, '\0');
  std::memcpy(bytes.data(), data, sizeof data);
  std::memcpy(bytes.data() + sizeof data, indices, sizeof indices);
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(R"({
    "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2,
      "material": 0}]}],
    "materials": [{"pbrMetallicRoughness": {"baseColorFactor": [0.5, 0.25, 0.125, 1],
      "metallicFactor": 0, "roughnessFactor": 0.5}}],
    "accessors": [
      {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, -2],
      "max": [2, 0, 0]},
      {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
      {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteOffset": 0, "byteLength": 48}, {"buffer": 0,
      "byteOffset": 48, "byteLength": 32},
                    {"buffer": 0, "byteOffset": 80, "byteLength": 12}],
    "buffers": [{"byteLength": 92}]})");
  json["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64(bytes);
  return json;
}

}  // namespace loden::importer::testing
