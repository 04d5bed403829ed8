// What the runtime's benchmarks share: materials of realistic size, and full-screen draws that are timed.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "material/model/material.h"
#include "runtime/gl/device.h"
#include "runtime/gl/gl_objects.h"
#include "runtime/gl/gl_target.h"
#include "runtime/gl/material/material_system.h"

namespace loden::bench {

// Sizes as the cooker's presets give them, texels seeded noise: cost does not depend on what they hold.
Material lodMaterial(uint32_t seed);  // seed preset: 5 levels, 8/2/2 components, 81 x 81 directions, RGBA32F
Material fusedMaterial(uint32_t seed);  // a flat and a reference band, 16 components each, 8 bit, grid tables
Material surfaceMaterial(uint32_t seed);  // three maps
// Waves of depth .1, as a height field over its own x and y.
GeometryImage wavyGeometry(int side);

// If an argument is --help or -h, prints `usage` and exits with 0. Exits with 1 for any other argument of a
// program whose `usage` names none.
void answerHelp(int argc, char** argv, const char* usage);

// Headless, with the driver's messages on stderr; exits if there is none. llvmpipe draws on the calling
// thread unless LP_NUM_THREADS says otherwise.
std::unique_ptr<runtime::Device> makeDevice();

std::shared_ptr<const ByteSource> assetSource(const Material& material);

// A full-screen triangle over `target`; varying location 0 is vec2 uv in [0,1]^2 over the target.
class FullScreen {
 public:
  explicit FullScreen(glm::ivec2 size);
  ~FullScreen();
  FullScreen(const FullScreen&) = delete;
  FullScreen& operator=(const FullScreen&) = delete;
  // Texts as in runtime/shader/shader_library.h, the triangle's own vertex text if empty; exits with the
  // compiler's message if one is wrong.
  runtime::GlProgram program(const std::string& fragment, std::span<const std::string> defines,
                             const std::string& vertex = {}) const;
  void draw(const runtime::GlProgram& program) const;
  std::vector<glm::vec4> read() const { return readLinear(target_); }

 private:
  runtime::RenderTarget target_;
  runtime::GlVertexArray array_;
};

// A material over 5 x 5 tile periods under one light, lambda from the first at the bottom to the second at
// the top. With LODEN_COUNT_FETCHES alpha is the number of texture instructions; with FULL_PARALLAX nothing
// of it is skipped.
extern const char kMaterialFragment[];
void drawAt(const FullScreen& screen, const runtime::GlProgram& program, glm::vec2 lambda);
double meanFetches(const FullScreen& screen, const runtime::GlProgram& program, glm::vec2 lambda);

// Median milliseconds of each task, all run in turn within each of `rounds` rounds, after two to warm up: of
// this process's processor time, which other programs disturb least, or by the driver's timer where a GPU
// draws.
std::vector<double> interleavedMedians(const std::vector<std::function<void()>>& tasks, int rounds);

// The value, or the issue on stderr and the exit code that goes with it.
template <class T>
T require(Result<T> result);
[[noreturn]] void fail(const Issue& issue);

template <class T>
T require(Result<T> result) {
  if (!result) fail(result.issue());
  return std::move(*result);
}

}  // namespace loden::bench
