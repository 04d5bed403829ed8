// Prints the colour of a material under one light: consumer FILE.loden
#include <cstdio>

#include "material/asset/asset.h"
#include "material/eval/evaluate.h"
#include "material/system/asset_io.h"

int main(int argc, char** argv) {
  if (argc != 2) return 1;
  const loden::Result<loden::Material> material = loden::readAsset(argv[1]);
  if (!material) {
    std::fprintf(stderr, "%s\n", material.issue().text.c_str());
    return 3;
  }
  const loden::Evaluator evaluator(*material);
  const glm::vec3 wo = glm::normalize(glm::vec3(0.4f, 0.0f, 1.0f));  // towards the eye, tangent frame
  const glm::vec3 wi = glm::normalize(glm::vec3(0.0f, 0.5f, 1.0f));  // towards the light
  const auto hit = evaluator.findHit(glm::vec2(0.25f, 0.75f), 0.0f, wo);
  const glm::vec3 rgb = evaluator.evaluate(hit, wi, wo);
  std::printf("%g %g %g\n", rgb.r, rgb.g, rgb.b);
}
