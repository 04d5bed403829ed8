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

// Materials with the sizes that the cooker's presets give, whose texels are seeded noise: what drawing costs
// does not depend on what texels hold. lodMaterial is the preset `seed`: 5 levels, 8/2/2 components, 81 x 81
// directions, RGBA32F. fusedMaterial has one band on the surface and one on the plane, 16 components each, 8
// bit, with grid tables. surfaceMaterial has three maps.
Material lodMaterial(uint32_t seed);
Material fusedMaterial(uint32_t seed);
Material surfaceMaterial(uint32_t seed);
// A height field of waves that are .1 tile lengths deep.
GeometryImage wavyGeometry(int side);

// If an argument is --help or -h, prints `usage` and exits with 0. Exits with 1 for any other argument of a
// program whose `usage` names none.
void answerHelp(int argc, char** argv, const char* usage);

// A headless device, which prints the driver's messages to stderr; the program exits if there is none.
// llvmpipe draws on the calling thread unless the environment sets LP_NUM_THREADS.
std::unique_ptr<runtime::Device> makeDevice();

std::shared_ptr<const ByteSource> assetSource(const Material& material);

// A full-screen triangle over `target`; varying location 0 is vec2 uv in [0,1]^2 over the target.
class FullScreen {
 public:
  explicit FullScreen(glm::ivec2 size);
  ~FullScreen();
  FullScreen(const FullScreen&) = delete;
  FullScreen& operator=(const FullScreen&) = delete;
  // A program of two texts as runtime/shader/shader_library.h takes them. If `vertex` is empty, it is the
  // text that draws the triangle. The program exits with the compiler's message if a text does not compile.
  runtime::GlProgram program(const std::string& fragment, std::span<const std::string> defines,
                             const std::string& vertex = {}) const;
  void draw(const runtime::GlProgram& program) const;
  std::vector<glm::vec4> read() const { return readLinear(target_); }

 private:
  runtime::RenderTarget target_;
  runtime::GlVertexArray array_;
};

// A fragment text that draws a material over 5 x 5 tile periods under one light. Its level of detail goes
// from lambda.x at the bottom to lambda.y at the top, as drawAt sets it. With LODEN_COUNT_FETCHES alpha is
// the number of texture instructions; with FULL_PARALLAX no part of the near term is skipped.
extern const char kMaterialFragment[];
void drawAt(const FullScreen& screen, const runtime::GlProgram& program, glm::vec2 lambda);
double meanFetches(const FullScreen& screen, const runtime::GlProgram& program, glm::vec2 lambda);

// Median milliseconds of each task over `rounds` rounds, after two rounds to warm up; in each round all tasks
// run in turn. Measures the processor time of this process, which other programs disturb least, or if a GPU
// draws, the time by the driver's timer.
std::vector<double> interleavedMedians(const std::vector<std::function<void()>>& tasks, int rounds);

// The result's value. If there is none, prints the issue to stderr and exits with its exit code.
template <class T>
T require(Result<T> result);
[[noreturn]] void fail(const Issue& issue);

template <class T>
T require(Result<T> result) {
  if (!result) fail(result.issue());
  return std::move(*result);
}

}  // namespace loden::bench
