// What the streaming bench walks through: real assets, and a scene with many materials of which few are seen.
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

// Every .loden file of the folder, by name; without a folder the four tiles as fused and as surface, baked
// (kept in out/studies/bakes) and cooked. Exits if there is none.
std::vector<Material> galleryMaterials(const std::filesystem::path& folder);

// `count` panels, 1.2 m apart, in a wall along x. Panel i shows material i, of its own asset and name, which
// differs from the one that it was made of by a tint. A sun, and light from the sky. A tile is as large as
// makes the nearest texels of a picture of `height` pixels as large as its pixels.
runtime::Scene galleryScene(const std::vector<Material>& materials, int count, int height);
// From where a visitor stands before panel `at` (fractions are between), looking along the wall: some seven
// are in view.
runtime::View galleryView(float at, glm::ivec2 size);

// `count` planes with one small material each; all but the first stand behind the camera.
runtime::Scene planeScene(const Material& material, int count);

// One scene with its own materials and renderer, ready to be drawn again and again.
struct Stage {
  std::unique_ptr<runtime::MaterialSystem> materials;
  std::shared_ptr<runtime::ShaderLibrary> shaders;
  std::unique_ptr<runtime::FrameRenderer> renderer;

  // Returns the milliseconds of CPU time that MaterialSystem::update took on this thread.
  double frame(const runtime::View& view, float seconds, const runtime::RenderTarget& target) const;
};
// With shaders of its own, or those of another stage.
Stage makeStage(const runtime::Device& device, const runtime::Scene& scene,
                const runtime::MaterialSystemOptions& options,
                std::shared_ptr<runtime::ShaderLibrary> shaders = nullptr);

}  // namespace loden::bench
