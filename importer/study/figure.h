// Pictures of a study as the papers print them, in PNG. importer/study/plot.h draws line plots.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <span>

#include "importer/base/picture.h"

namespace loden::importer {

// A picture of side x side texels of linear RGB, each magnify x magnify pixels; texel row y = 0 is at the
// bottom.
Picture texelPicture(std::span<const glm::vec3> texels, int side, int magnify = 1);

// A picture of values from `least` (black) to `most` (white), logarithmic, as in FBTF figure 11; row y = 0 is
// at the bottom. A value below zero stands for no value, and is blue.
Picture logarithmicPicture(std::span<const double> values, int side, double least, double most);

// Writes the picture; creates the folder first.
Status writeFigure(const Picture& picture, const std::filesystem::path& path);

}  // namespace loden::importer
