// Pictures of a study as the papers print them, PNG; lines over numbers are in plot.h.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <span>

#include "importer/base/picture.h"

namespace loden::importer {

// Linear RGB of side x side texels, each magnify x magnify pixels; texel row y = 0 at the bottom.
Picture texelPicture(std::span<const glm::vec3> texels, int side, int magnify = 1);

// Values from `least` (black) to `most` (white), logarithmic, as FBTF figure 11; row y = 0 at the bottom.
// Values below zero are no values: they are blue.
Picture logarithmicPicture(std::span<const double> values, int side, double least, double most);

// Makes the folder first.
Status writeFigure(const Picture& picture, const std::filesystem::path& path);

}  // namespace loden::importer
