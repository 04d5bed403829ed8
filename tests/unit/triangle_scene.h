// A sound glTF scene of one triangle in a folder of its own, for tests that damage it.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

namespace loden::test {

class TriangleScene : public testing::Test {
 protected:
  TriangleScene() {
    std::string folder = (std::filesystem::temp_directory_path() / "loden_scene_XXXXXX").string();
    if (::mkdtemp(folder.data())) folder_ = folder;
    write("scene.bin", bytes());
  }
  ~TriangleScene() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const std::filesystem::path& name, const std::string& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return folder_ / name;
  }

  static nlohmann::json scene() {
    return nlohmann::json::parse(R"({
      "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 2]}],
      "nodes": [{"mesh": 0, "children": [1]}, {}, {}],
      "meshes": [{"primitives": [
        {"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
      "materials": [{"name": "cloth"}],
      "buffers": [{"uri": "scene.bin", "byteLength": 80}],
      "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24},
                      {"buffer": 0, "byteOffset": 60, "byteLength": 8},
                      {"buffer": 0, "byteOffset": 68, "byteLength": 12}],
      "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
                    {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"},
                    {"bufferView": 2, "componentType": 5123, "count": 3, "type": "SCALAR"},
                    {"bufferView": 3, "componentType": 5126, "count": 1, "type": "VEC3"}]})");
  }
  // Content of the scene's buffer: positions, texture coordinates, the indices 0 1 2 7 (of which 7 is out of
  // range), and a point that is not finite.
  static std::string bytes() {
    std::string bytes;
    const auto add = [&](auto value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof value); };
    for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) add(v);
    for (const float v : {0.f, 0.f, 1.f, 0.f, 0.f, 1.f}) add(v);
    for (const uint16_t v : {uint16_t(0), uint16_t(1), uint16_t(2), uint16_t(7)}) add(v);
    for (const float v : {std::numeric_limits<float>::infinity(), 0.f, 0.f}) add(v);
    return bytes;
  }

  std::filesystem::path folder_;
};

}  // namespace loden::test
