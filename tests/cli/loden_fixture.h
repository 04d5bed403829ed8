// One small bake and its asset, made once per build of the tool and shared by all tests.
#pragma once

#include <sys/file.h>

#include "tests/cli/run_tool.h"

namespace loden::test {

inline ToolRun loden(const std::vector<std::string>& arguments,
                     const std::filesystem::path& interrupt_at = {}, int signal = SIGINT) {
  return runTool(LODEN_TOOL, arguments, interrupt_at, signal);
}

// Folder with `bake` (pulli, 8 x 8 texels, Bonn directions) and `material.loden` (mode lod). Tests run in
// parallel processes: the first one makes it, under a lock.
inline const std::filesystem::path& sharedFolder() {
  static const std::filesystem::path folder = [] {
    const std::filesystem::path path = LODEN_CLI_WORK;
    std::filesystem::create_directories(path);
    const int lock = open((path / "lock").c_str(), O_CREAT | O_RDWR, 0600);
    flock(lock, LOCK_EX);
    const auto made = path / "made";
    if (!std::filesystem::exists(made) ||
        std::filesystem::last_write_time(made) < std::filesystem::last_write_time(LODEN_TOOL)) {
      std::filesystem::remove_all(path / "bake");
      const ToolRun bake =
          loden({"bake", "builtin:pulli", "-o", path / "bake", "--size", "8", "--supersample", "1", "-q"});
      const ToolRun cook =
          loden({"cook", path / "bake", "-o", path / "material.loden", "--mode", "lod", "-q"});
      if (bake.exit_code == 0 && cook.exit_code == 0)
        writeText(made, "");
      else
        std::fprintf(stderr, "%s%s", bake.err.c_str(), cook.err.c_str());
    }
    close(lock);
    return path;
  }();
  return folder;
}

inline std::string sharedBake() {
  return sharedFolder() / "bake";
}
inline std::string sharedAsset() {
  return sharedFolder() / "material.loden";
}

// Two textured triangles and a second material with an unknown extension; positions and uvs in scene.bin.
inline void writeScene(const std::filesystem::path& folder) {
  std::string bin;
  const auto add = [&bin](float value) { bin.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (const float v : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 0.f, 1.f, 0.f}) add(v);
  for (const float v : {0.f, 0.f, 1.f, 0.f, 0.f, 1.f}) add(v);
  writeText(folder / "scene.bin", bin);
  writeText(folder / "scene.gltf", R"({
  "asset": {"version": "2.0", "generator": "by hand"},
  "scene": 0,
  "scenes": [{"nodes": [0]}],
  "nodes": [{"mesh": 0, "extras": {"kept": [1, 2.5, "three"]}}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
  "materials": [{"name": "Cloth"}, {"name": "Other", "extensions": {"VENDOR_thing": {"x": 0.1}}}],
  "extensionsUsed": ["VENDOR_thing"],
  "buffers": [{"uri": "scene.bin", "byteLength": 60}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0,
      0], "max": [1, 1, 0]},
                {"bufferView": 1, "componentType": 5126, "count": 3, "type": "VEC2"}]
})");
}

}  // namespace loden::test
