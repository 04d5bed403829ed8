// A square with texture coordinates, and noise to put on it.
#pragma once

#include <random>

#include "runtime/scene/scene.h"

namespace loden::test {

// In the plane z = 0 around the origin, facing +z, with coordinates of the first set from 0 at the top left
// to 1.
inline runtime::Mesh texturedSquare(float side) {
  runtime::Mesh mesh;
  mesh.name = "square";
  for (const glm::vec2 uv : {glm::vec2(0, 1), glm::vec2(1, 1), glm::vec2(1, 0), glm::vec2(0, 0)}) {
    runtime::Vertex vertex;
    vertex.position = {(uv.x - 0.5f) * side, (0.5f - uv.y) * side, 0};
    vertex.uv = uv;
    mesh.vertices.push_back(vertex);
    mesh.uv_sets[0].push_back(uv);
  }
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.bounds = runtime::boundsOf(mesh);
  return mesh;
}

// Opaque, with structure at all scales.
inline runtime::SceneImage noiseImage(glm::ivec2 size, uint32_t seed) {
  std::mt19937 random(seed);
  runtime::SceneImage image{"noise " + std::to_string(seed), size, {}};
  for (int y = 0; y < size.y; ++y)
    for (int x = 0; x < size.x; ++x) {
      glm::u8vec4 code(0, 0, 0, 255);
      for (int c = 0; c < 3; ++c) code[c] = uint8_t((random() & 63) + 48 * ((x * (c + 2) / 37 + y / 23) & 3));
      image.pixels.push_back(code);
    }
  return image;
}

}  // namespace loden::test
