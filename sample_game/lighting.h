// Light from all around: which panorama, turned how, and what of it a frame needs.
#pragma once

#include <filesystem>
#include <optional>

#include "material/base/result.h"
#include "material/model/environment.h"
#include "runtime/frame/frame.h"

namespace loden::walk {

struct Lighting {
  std::optional<Panorama> panorama;
  bool neutral = false;             // the built-in studio, not somebody's picture
  bool y_up = true;                 // of the world; panoramas have z up, as analytic surfaces do
  double turn = 0;                  // radians around the world's up
  std::filesystem::path file = {};  // empty: built in, or none

  // Sets environment, reflections and sky of a frame; clears them without a panorama. Takes half a second.
  void apply(runtime::FrameSettings& settings) const;
};

// Issues of readPanorama.
Result<Lighting> panoramaLighting(const std::filesystem::path& file);
Lighting neutralLighting();

}  // namespace loden::walk
