// One material on a hanging cloth, a sphere and a plane: what `loden_walk knit.loden` shows.
#pragma once

#include "runtime/scene/scene.h"
#include "sample_game/dress.h"

namespace loden::walk {

// The scene, in metres with y up and without lights. Texture coordinates are in metres, so that tiles have
// the same length everywhere.
runtime::Scene showcaseScene(const std::filesystem::path& asset, const TileFacts& facts, double period);

}  // namespace loden::walk
