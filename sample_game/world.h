// Everything that a walk draws with. Members are in the order in which they are set up.
#pragma once

#include <memory>
#include <optional>

#include "material/base/result.h"
#include "runtime/frame/frame.h"
#include "runtime/gl/device.h"
#include "runtime/gl/material/material_system.h"
#include "runtime/scene/camera.h"
#include "runtime/shader/shader_library.h"
#include "sample_game/lighting.h"
#include "sample_game/options.h"
#include "sample_game/truth.h"

namespace loden::walk {

struct World {
  std::unique_ptr<runtime::Device> device;
  std::unique_ptr<runtime::ShaderLibrary> shaders;
  std::unique_ptr<runtime::MaterialSystem> materials;
  std::unique_ptr<runtime::FrameRenderer> renderer;
  runtime::FrameSettings settings;
  runtime::CameraPath path;  // has one key if the camera does not move
  runtime::Scene scene;      // without its images
  Lighting lighting;
  int animation = -1;      // index of the scene's animation that is played; -1: none
  int scene_camera = -1;   // index of the scene's camera that shows the picture; -1: the path's camera does
  double animated_to = 0;  // time in the animation, seconds
  std::optional<Truth> truth;

  // Moves the scene to where its animation is `seconds` after the first frame, which was at `first` seconds
  // of the animation; at its end the animation starts over. Returns the camera if it is one of the scene's.
  std::optional<Camera> animate(double seconds, double first);
  // Whether a material is a height field, so that parallax occlusion mapping can draw it.
  bool hasHeightField() const;
  // The pose of the scene that was drawn last.
  runtime::ScenePose pose() const;
  // Replaces the scene, and sets a camera that sees all of the new one. If that fails, the old scene stays.
  Status replaceScene(runtime::Scene next, double aspect);
};
Result<World> makeWorld(const Options& options);

}  // namespace loden::walk
