// What dynamic branching saves: texture instructions per pixel and frame time against lambda, with the branch
// over bands on and off, in one interleaved run; beside a diffuse and normal map. Full screen, one light.
#include <epoxy/gl.h>

#include <cstdio>
#include <limits>

#include "runtime/gl/material/gl_texture.h"
#include "runtime/stream/shader_variants.h"
#include "shaders/loden_shared.h"
#include "tests/bench/bench_support.h"

namespace {

using namespace loden;
using namespace loden::bench;
using namespace loden::runtime;

constexpr glm::ivec2 kSize{400, 400};
constexpr int kRounds = 15;

// What every engine has: one diffuse and one normal map, trilinear.
const char kNormalMap[] = R"(
layout(binding = LODEN_MAX_UNITS) uniform sampler2DArray normal_map;
layout(binding = LODEN_MAX_UNITS + 1) uniform sampler2DArray diffuse_map;
layout(location = 0) in vec2 uv;
layout(location = 0) out vec4 color;
void main() {
  vec3 wi = normalize(vec3(0.3, 0.2, 1.0));
  vec3 n = normalize(texture(normal_map, vec3(uv * 5.0, 0.0)).xyz);
  color = vec4(texture(diffuse_map, vec3(uv * 5.0, 0.0)).xyz * max(dot(n, wi), 0.0), 2.0);
})";

GlTexture uploaded(const Texture& map, int unit, const char* label) {
  const PartTexture part{unit, Sampling::kRepeatTrilinear, false, label, map};
  GlTexture texture = allocateTexture(part, label);
  int64_t unlimited = std::numeric_limits<int64_t>::max();
  TextureUpload().step(part, texture.name(), unlimited);
  glBindTextureUnit(GLuint(unit), texture.name());
  return texture;
}

struct Subject {
  const char* name;
  MaterialId id;
  GlProgram branching, straight, counting, counting_straight;
};

GlProgram materialProgram(const FullScreen& screen, const MaterialVariant& variant, bool branch, bool count) {
  std::vector<std::string> defines = variantDefines(variant);
  if (count) defines.push_back("LODEN_COUNT_FETCHES 1");
  if (!branch) defines.push_back("LODEN_NO_BRANCH 1");
  return screen.program(kMaterialFragment, defines);
}

Subject makeSubject(const FullScreen& screen, MaterialSystem& materials, const Material& material,
                    const char* name) {
  const MaterialId id = require(materials.load(assetSource(material), name));
  materials.demand(id, 0);
  materials.finishLoading();
  const MaterialVariant variant = materials.variant(id);
  return {name,
          id,
          materialProgram(screen, variant, true, false),
          materialProgram(screen, variant, false, false),
          materialProgram(screen, variant, true, true),
          materialProgram(screen, variant, false, true)};
}

void report(const FullScreen& screen, MaterialSystem& materials, const Subject& subject,
            const GlProgram& normal_map) {
  std::vector<glm::vec2> lambdas;
  for (float lambda = 0; lambda <= 5; lambda += 1) lambdas.push_back({lambda, lambda});
  lambdas.push_back({0, 6});  // a floor into the distance: every pixel its own lambda
  std::vector<std::function<void()>> tasks;
  tasks.push_back([&] { screen.draw(normal_map); });
  for (const glm::vec2 lambda : lambdas)
    for (const GlProgram* program : {&subject.branching, &subject.straight})
      tasks.push_back([&, lambda, program] {
        materials.bind(subject.id);
        drawAt(screen, *program, lambda);
      });
  const std::vector<double> ms = interleavedMedians(tasks, kRounds);
  materials.bind(subject.id);
  for (size_t i = 0; i < lambdas.size(); ++i) {
    const std::string lambda = lambdas[i].x == lambdas[i].y ? std::to_string(int(lambdas[i].x)) : "0..6";
    std::printf("%-8s %6s %10.1f %10.1f %10.2f %10.2f %10.2f\n", subject.name, lambda.c_str(),
                meanFetches(screen, subject.counting, lambdas[i]),
                meanFetches(screen, subject.counting_straight, lambdas[i]), ms[1 + 2 * i], ms[2 + 2 * i],
                ms[1 + 2 * i] / ms[0]);
  }
}

}  // namespace

int main(int argc, char** argv) {
  answerHelp(argc, argv, "bench_branching");
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  const std::unique_ptr<Device> device = makeDevice();
  const std::unique_ptr<MaterialSystem> materials = require(MaterialSystem::create(*device, {}));
  const FullScreen screen(kSize);
  const Subject lod = makeSubject(screen, *materials, lodMaterial(1), "lod");
  const Subject fused = makeSubject(screen, *materials, fusedMaterial(2), "fused");
  const Subject surface = makeSubject(screen, *materials, surfaceMaterial(3), "surface");
  const std::string units = "LODEN_MAX_UNITS " + std::to_string(LODEN_MAX_UNITS);
  const GlProgram normal_map = screen.program(kNormalMap, {&units, 1});
  const Material maps = surfaceMaterial(4);  // in units of their own, which no material binds
  const GlTexture normals = uploaded(maps.surface->normal, LODEN_MAX_UNITS, "normal map"),
                  colors = uploaded(maps.surface->color, LODEN_MAX_UNITS + 1, "diffuse map");

  std::printf("# bench_branching: %d x %d pixels, 1 light, median of %d interleaved frames, %s\n", kSize.x,
              kSize.y, kRounds, device->capabilities().renderer.c_str());
  std::printf("# fetches: texture instructions per pixel; x normal map: time against diffuse + normal map\n");
  std::printf("%-8s %6s %10s %10s %10s %10s %10s\n", "mode", "lambda", "fetches", "no branch", "ms",
              "no branch", "x nrm map");
  for (const Subject* subject : {&lod, &fused, &surface}) report(screen, *materials, *subject, normal_map);
  return 0;
}
