// Everything that a walk draws with, set up in the order in which the parts need each other.
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
  runtime::CameraPath path;  // of one key where nothing moves
  runtime::Scene scene;      // without its images
  Lighting lighting;
  int animation = -1;      // of the scene; -1: nothing moves
  int scene_camera = -1;   // of the scene, that the picture is seen through; -1: the path's
  double animated_to = 0;  // seconds into the animation
  std::optional<Truth> truth;

  // Moves the scene to `seconds` since its first frame, the animation starting over at its end. The camera
  // that the picture is then seen through, if it is the scene's.
  std::optional<Camera> animate(double seconds, double first);
  // Whether parallax occlusion mapping has something to draw.
  bool hasHeightField() const;
  // The pose that was drawn last.
  runtime::ScenePose pose() const;
  // Walks through another scene from now on, with a camera that sees all of it; where that cannot be, the old
  // one stays.
  Status replaceScene(runtime::Scene next, double aspect);
};
Result<World> makeWorld(const Options& options);

}  // namespace loden::walk
