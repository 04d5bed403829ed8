// The names and layouts of a baked output's files, shared by its writer and its reader. Not installed.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "importer/btf/baked_output.h"

namespace loden::importer {

std::filesystem::path btfPath(const std::filesystem::path& folder, int view);
std::filesystem::path flatPath(const std::filesystem::path& folder, int view);
std::filesystem::path visiblePath(const std::filesystem::path& folder, int view);
std::filesystem::path vdimPath(const std::filesystem::path& folder, glm::ivec2 zeniths_azimuths);
std::filesystem::path concentricVdimPath(const std::filesystem::path& folder, int directions);
std::filesystem::path surfacePath(const std::filesystem::path& folder, const std::string& map);

inline constexpr int kMaxVdimSide = 256;  // zeniths, azimuths, or directions per side, of a VDIM

// The layout of the atlas of one view: cells of side x side, in rows of `columns`.
struct AtlasLayout {
  int side = 0, cells = 0, columns = 0;
  static AtlasLayout forLights(int side, int lights);
  int width() const { return columns * side; }
  int height() const { return (cells + columns - 1) / columns * side; }
  size_t pixel(int cell, int i, int j) const {
    return size_t(cell / columns * side + j) * size_t(width()) + size_t(cell % columns * side + i);
  }
};

// The names of fill methods in --fill and in bake.json.
const char* fillName(FillMethod method);
std::optional<FillMethod> fillByName(const std::string& name);

// The text of bake.json; its bytes are the same for the same manifest.
std::string manifestText(const BakeManifest& manifest);
Result<BakeManifest> parseManifest(const std::string& text, const std::string& where);

}  // namespace loden::importer
