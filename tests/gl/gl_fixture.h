// A headless device whose driver messages are kept, and a program that fills a target.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "material/asset/asset.h"
#include "runtime/gl/device.h"
#include "runtime/gl/gl_objects.h"
#include "runtime/gl/gl_target.h"
#include "runtime/gl/material/material_system.h"
#include "runtime/scene/scene.h"

namespace loden::test {

// A test with a device and its log. The test fails if the driver logs a message of medium severity or above.
class GlTest : public ::testing::Test {
 protected:
  void SetUp() override;
  void TearDown() override;

  std::unique_ptr<runtime::Device> makeDevice();
  std::unique_ptr<runtime::MaterialSystem> makeMaterials(const runtime::MaterialSystemOptions& options = {});
  runtime::MaterialId load(runtime::MaterialSystem& system, const Material& material);

  std::vector<Issue> messages;  // those of all devices that makeDevice has made
  int tolerated = 0;            // how many warnings and errors the test expects
  std::unique_ptr<runtime::Device> device;
};

std::shared_ptr<const ByteSource> assetSource(const Material& material);

// The image as a repeated texture of sRGB colours, with linear filters.
runtime::ImageTexture imageTexture(const runtime::SceneImage& image, bool mipmapped = true);

// A picture of one material, drawn by the shader library alone; linear RGB, [height][width]. x runs over the
// target; lambda, light and view are fixed. GL state is left changed.
std::vector<glm::vec4> drawMaterial(runtime::MaterialSystem& system, runtime::MaterialId id, float lambda,
                                    glm::ivec2 size = {32, 32});

}  // namespace loden::test
