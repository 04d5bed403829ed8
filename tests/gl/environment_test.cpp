// Panoramas from files, and the renderer under light from all around.
#include "material/model/environment.h"

#include <epoxy/gl.h>

#include <cmath>
#include <cstdio>
#include <fstream>

#include "material/base/issues.h"
#include "material/eval/evaluate.h"
#include "material/model/directions.h"
#include "material/model/leading_part.h"
#include "runtime/frame/frame.h"
#include "runtime/scene/image_read.h"
#include "runtime/scene/mesh_analytic.h"
#include "tests/gl/gl_fixture.h"
#include "tests/unit/material_fixtures.h"

namespace loden::test {
namespace {

using namespace runtime;

using EnvironmentTest = GlTest;

class TemporaryFile {
 public:
  explicit TemporaryFile(const std::string& bytes) {
    const int file = ::mkstemp(name_);
    EXPECT_EQ(::write(file, bytes.data(), bytes.size()), ssize_t(bytes.size()));
    ::close(file);
  }
  ~TemporaryFile() { std::remove(name_); }
  const char* path() const { return name_; }

 private:
  char name_[32] = "/tmp/loden_panorama_XXXXXX";
};

TEST_F(EnvironmentTest, ReadsRadiancePanoramas) {
  // Two rows of two pixels: (mantissas, exponent); 128 * 2^(129 - 136) = 1.
  const TemporaryFile file(std::string("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2 +X 2\n") +
                           std::string("\x80\x40\x20\x81\0\0\0\0\x80\x80\x80\x82\x80\x80\x80\x80", 16));
  const Result<Panorama> panorama = readPanorama(file.path());
  ASSERT_TRUE(panorama.ok()) << panorama.issue().text;
  ASSERT_EQ(panorama->width, 2);
  EXPECT_EQ(panorama->pixels[0], glm::vec3(1, 0.5f, 0.25f));
  EXPECT_EQ(panorama->pixels[1], glm::vec3(0));
  EXPECT_EQ(panorama->pixels[2], glm::vec3(2));
  EXPECT_EQ(panorama->pixels[3], glm::vec3(0.5f));
}

TEST_F(EnvironmentTest, RefusesWhatIsNoPanorama) {
  EXPECT_EQ(readPanorama("/nonexistent.hdr").issue().id, issue_id::kCannotOpen);
  const TemporaryFile empty(""), text("hello"),
      huge("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 20000 +X 20000\n"),
      cut("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 64\n\x02\x02");
  for (const TemporaryFile* file : {&empty, &text, &huge}) EXPECT_FALSE(readPanorama(file->path()).ok());
  // Long enough for its extents, but the third line's runs end within the line.
  std::string lines = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 3 +X 16\n";
  for (int y = 0; y < 3; ++y) {
    lines += std::string("\x02\x02\x00\x10", 4);
    for (int channel = 0; channel < 4; ++channel) lines += "\x90\x80";
  }
  EXPECT_TRUE(readPanorama(TemporaryFile(lines).path()).ok());
  std::string too_long = lines, no_run = lines;
  too_long[lines.size() - 2] = '\x91';
  no_run[lines.size() - 2] = no_run[lines.size() - 1] = '\0';
  for (const std::string& bytes : {too_long, no_run, lines.substr(0, lines.size() - 1)})
    EXPECT_FALSE(readPanorama(TemporaryFile(bytes).path()).ok());
  EXPECT_FALSE(readPanorama(cut.path()).ok());
}

struct Shown {
  const char* what;
  Material stored, shown;
  float lambda;  // where the coarsest mip of the bands is: the same everywhere
};

// A plane seen at an angle under a polynomial light, against the CPU evaluator at the pixels' x.
TEST_F(EnvironmentTest, RendererShowsWhatTheEvaluatorSays) {
  Material lead = splitFusedMaterial();
  lead.bands[1] = leadOf(lead.bands[1]);
  for (const Shown& c : {Shown{"one chunk", fusedMaterial(), fusedMaterial(), 6},
                         Shown{"whole", splitFusedMaterial(), splitFusedMaterial(), 5},
                         Shown{"leading part", splitFusedMaterial(), lead, 6}}) {
    SCOPED_TRACE(c.what);
    const Material& material = c.stored;
    Scene scene = analyticScene(SurfaceKind::kPlane, {}, glm::vec3(0, 0, 1));
    scene.lights.clear();
    scene.assets[0].embedded = std::move(*serializeAsset(material));
    scene.assets[0].name = "fused";
    auto materials = makeMaterials();
    ShaderLibrary shaders(*device, {});
    auto renderer = FrameRenderer::create(*device, shaders, *materials, scene);
    ASSERT_TRUE(renderer.ok());
    FrameSettings settings;
    settings.tone = ToneCurve::kClip;
    settings.lambda = c.lambda;
    settings.environment.emplace();
    settings.environment->light =
        skyLight(glm::vec3(3, 2, 1), glm::vec3(0), glm::normalize(glm::vec3(0.5f, 0.2f, 1)));
    settings.environment->suns = {
        {glm::normalize(glm::vec3(-0.4f, 0.3f, 0.8f)), glm::vec3(0.2f, 0.3f, 0.4f)}};
    Camera camera;
    camera.position = {0, -1, 1};
    camera.fov_degrees = 1;
    const RenderTarget target = *makeRenderTarget({9, 9}, ColorFormat::kLinear32, "frame");
    (*renderer)->prepare(makeView(camera, target.size), settings);
    materials->finishLoading();
    ASSERT_TRUE((*renderer)->draw({target.framebuffer.name(), target.size}).ok());
    const glm::vec4 pixel = readLinear(target)[40];

    Evaluator evaluator(c.shown);
    evaluator.prepareEnvironment();
    const glm::vec3 wo = glm::normalize(glm::vec3(0, -1, 1));
    const auto hit = evaluator.findHit(glm::vec2(0), c.lambda, wo);
    const HemisphereLight light = hemisphereLight(settings.environment->light, glm::mat3(1));
    const EnvironmentSun& sun = settings.environment->suns[0];
    const glm::vec3 around = evaluator.evaluateEnvironment(hit, light, wo);
    const glm::vec3 from_sun = evaluator.evaluate(hit, sun.direction, wo) * sun.irradiance;
    const glm::vec3 expected =
        (glm::max(around, 0.0f) + glm::max(from_sun, 0.0f)) * (float(kPi) * material.value_scale);
    EXPECT_GT(glm::length(expected), 0.05f);
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(pixel[k], std::max(expected[k], 0.0f), 1e-3) << k;
  }
}

}  // namespace
}  // namespace loden::test
