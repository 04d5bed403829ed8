// One material on a hanging cloth, a sphere and a plane: what `loden_walk knit.loden` shows.
#pragma once

#include "runtime/scene/scene.h"
#include "sample_game/dress.h"

namespace loden::walk {

// Metres, y up; texture coordinates are in metres, so that a tile is as long everywhere. Without lights.
runtime::Scene showcaseScene(const std::filesystem::path& asset, const TileFacts& facts, double period);

}  // namespace loden::walk
