// Small bakes, for tests, that take only a moment.
#pragma once

#include <gtest/gtest.h>

#include <map>

#include "importer/bake/bake.h"
#include "tests/unit/importer_meshes.h"

namespace loden::importer::testing {

inline BakeOptions smallBake(int size = 8) {
  BakeOptions options;
  options.size = size;
  options.geometry_size = 16;
  options.directions = concentricDirections(3);
  options.vdims = {{4, 5}};
  options.quiet = true;
  return options;
}

// The bytes of every file below a folder, by its name relative to the folder.
inline std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ostringstream bytes;
    bytes << std::ifstream(entry.path(), std::ios::binary).rdbuf();
    files[std::filesystem::relative(entry.path(), folder).string()] = bytes.str();
  }
  return files;
}

inline BakedOutput baked(const Tile& tile, const std::filesystem::path& folder, const BakeOptions& options) {
  const auto report = bake(tile, tile.name, folder, options);
  EXPECT_TRUE(report.ok()) << report.issue().text;
  auto output = BakedOutput::open(folder);
  EXPECT_TRUE(output.ok()) << output.issue().text;
  return *output;
}

}  // namespace loden::importer::testing
