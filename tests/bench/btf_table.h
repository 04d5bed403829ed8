// The whole BTF as textures, read and interpolated in four dimensions. Compressions are measured against it.
#pragma once

#include <array>
#include <cstdint>

#include "importer/btf/baked_output.h"
#include "runtime/gl/gl_objects.h"

namespace loden::bench {

// All light-view images of a bake over Bonn's 81 directions as repeating, mip-mapped layers, RGB9E5. GL
// promises 2048 layers only, so they are spread over eight array textures: by the parity of the view's ring,
// of the light's ring and of the light's place on it. Two neighbouring rings, and two neighbours on a ring,
// then lie in different textures.
class BtfTable {
 public:
  static constexpr int kTextures = 8;
  explicit BtfTable(const importer::BakedOutput& baked);
  void bind() const;  // to the texture units from LODEN_MAX_UNITS on
  uint64_t bytes() const { return bytes_; }

 private:
  std::array<runtime::GlTexture, kTextures> textures_;
  uint64_t bytes_ = 0;
};

// GLSL text of vec3 btf_table_value(vec2 x, float lambda, vec3 wi, vec3 wo). It interpolates light and view
// linearly between two samples on a ring and between two rings, and x trilinearly, by 16 texture
// instructions. The text must follow that of loden_material.glsl.
extern const char kBtfTableLibrary[];

}  // namespace loden::bench
