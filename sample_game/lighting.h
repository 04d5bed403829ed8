// Light from an environment: the panorama, how it is turned, and what a frame needs of it.
#pragma once

#include <filesystem>
#include <optional>

#include "material/base/result.h"
#include "material/model/environment.h"
#include "runtime/frame/frame.h"

namespace loden::walk {

struct Lighting {
  std::optional<Panorama> panorama;
  bool neutral = false;             // the panorama is the built-in studio, not a picture from a file
  bool y_up = true;                 // y is up in the world; in panoramas, and for analytic surfaces, z is
  double turn = 0;                  // rotation of the panorama around the world's up, radians
  std::filesystem::path file = {};  // empty if the panorama is built in, or there is none

  // Sets environment, reflections and sky of a frame, or clears them if there is no panorama. This takes half
  // a second.
  void apply(runtime::FrameSettings& settings) const;
};

// Lighting by the panorama in a file, or by the built-in studio. Issues: those of readPanorama.
Result<Lighting> panoramaLighting(const std::filesystem::path& file);
Lighting neutralLighting();

}  // namespace loden::walk
