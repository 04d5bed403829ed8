// Scenes of the streaming benchmark: real assets, and many materials of which few are seen at a time.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "material/model/material.h"
#include "runtime/frame/frame.h"
#include "runtime/gl/gl_target.h"
#include "runtime/gl/material/material_system.h"
#include "runtime/scene/camera.h"
#include "runtime/scene/scene.h"
#include "runtime/shader/shader_library.h"

namespace loden::bench {

// The materials of every .loden file of the folder, sorted by name. Without a folder they are the four
// builtin tiles in the modes fused and surface, which are baked (into out/studies/bakes) and cooked. The
// program exits if there is none.
std::vector<Material> galleryMaterials(const std::filesystem::path& folder);

// A wall along x of `count` panels, 1.2 m apart, under a sun. Each panel shows a material of its own:
// one of `materials` in turn, with a tint, as an asset with a name of its own. Tiles have the size at which
// the nearest texels in a picture of `height` pixels are as large as pixels.
runtime::Scene galleryScene(const std::vector<Material>& materials, int count, int height);
// The view of a visitor who stands before panel `at` and looks along the wall; a fraction is a place between
// two panels. About seven panels are in view.
runtime::View galleryView(float at, glm::ivec2 size);

// A scene of `count` planes, each with an asset of its own that holds `material`; all planes but the first
// stand behind the camera.
runtime::Scene planeScene(const Material& material, int count);

// One scene with its own materials and renderer, ready to be drawn again and again.
struct Stage {
  std::unique_ptr<runtime::MaterialSystem> materials;
  std::shared_ptr<runtime::ShaderLibrary> shaders;
  std::unique_ptr<runtime::FrameRenderer> renderer;

  // Returns the milliseconds of CPU time that MaterialSystem::update took on this thread.
  double frame(const runtime::View& view, float seconds, const runtime::RenderTarget& target) const;
};
// A stage with the shaders of another stage, or with shaders of its own if `shaders` is null.
Stage makeStage(const runtime::Device& device, const runtime::Scene& scene,
                const runtime::MaterialSystemOptions& options,
                std::shared_ptr<runtime::ShaderLibrary> shaders = nullptr);

}  // namespace loden::bench
