// Any bytes as a tile for `loden bake`: no crash, no endless loop, and what is accepted is a tile that rays
// can be traced through. Inputs that begin as glTF does are read as that, others as OBJ, whose MTL is what
// follows from the first "newmtl" on.
#include <cmath>
#include <cstdint>

#include "importer/tile/tile.h"
#include "importer/tile/tile_tracer.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using loden::fuzz::require;

bool isFinite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

std::filesystem::path writeTile(const loden::fuzz::InputFolder& folder, std::string_view bytes) {
  if (bytes.starts_with("glTF")) return folder.write("input.glb", bytes);
  if (bytes.starts_with("{")) return folder.write("input.gltf", bytes);
  const size_t materials = std::min(bytes.find("newmtl"), bytes.size());
  folder.write("input.mtl", bytes.substr(materials));
  return folder.write("input.obj", bytes.substr(0, materials));
}

void checkTile(const loden::importer::Tile& tile) {
  const size_t vertices = tile.positions.size();
  require(tile.aspect > 0 && std::isfinite(tile.aspect));
  require(!tile.triangles.empty() && tile.charts.size() == tile.triangles.size());
  require(tile.normals.size() == vertices && tile.params.size() == vertices && tile.brdfs.size() == vertices);
  require(tile.texture_points.empty() || tile.texture_points.size() == vertices);
  for (const auto& triangle : tile.triangles)
    for (int k = 0; k < 3; ++k) require(triangle[k] < vertices);
  for (size_t i = 0; i < vertices; ++i) {
    require(isFinite(tile.positions[i]) && tile.positions[i].z <= 1e-9);
    require(isFinite(tile.normals[i]) && std::isfinite(tile.params[i].x + tile.params[i].y));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const loden::fuzz::InputFolder folder;
  const auto tile = loden::importer::loadTile(writeTile(folder, loden::fuzz::textOf(data, size)).string());
  if (!tile) {
    require(!tile.issue().text.empty());
    return 0;
  }
  checkTile(*tile);
  return 0;
}
