// Ways to draw a tile on a plane that fills the picture: Loden's modes, the published ones and what engines
// draw (peer_renderers.h), all through one interface.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "runtime/gl/material/material_system.h"
#include "shaders/loden_shared.h"
#include "tests/bench/bench_support.h"
#include "tests/bench/btf_table.h"
#include "tests/bench/plane_view.h"

namespace loden::bench {

// Texture units of materials, then those free for renderers of other kinds.
inline constexpr int kFreeUnit = LODEN_MAX_UNITS;
inline constexpr int kUnits = kFreeUnit + BtfTable::kTextures;

// By unit: bytes of the texels that one texture instruction reads there.
class FetchBytes {
 public:
  explicit FetchBytes(const Material& material);
  // Of a texture outside the material.
  void setFree(int unit, int texel_bytes, int texels) { bytes_[unit] = float(texel_bytes * texels); }
  const float* data() const { return bytes_; }

 private:
  void set(int unit, const Texture& texture, int texels);
  float bytes_[kUnits] = {};
};

// One way to draw, with a material system of its own so that its bytes can be read off.
struct TileRenderer {
  std::string name, setting;
  std::unique_ptr<runtime::MaterialSystem> materials;
  runtime::MaterialId id;
  FetchBytes fetch_bytes;
  // Of the fragment shader; SUM_LIGHTS(value of wi) or SHOW(rgb) ends it.
  std::string main;
  std::vector<std::string> defines;  // beside the variant's
  bool uses_material = true;         // its bytes count
  uint64_t extra_bytes = 0;          // of textures and meshes outside the system
  // What else it needs before its draw; null: nothing.
  std::function<void(const runtime::GlProgram&)> prepare;
  // Instead of a triangle that fills the picture; empty and null: that.
  std::string vertex;
  std::function<void(const PlaneView&)> draw;

  uint64_t bytes() const;
};

// With the material on the GPU, all of it.
TileRenderer loadRenderer(const runtime::Device& device, const std::string& name, const std::string& setting,
                          const Material& material, Lookup lookup);
// The equation itself, at what the lookup finds.
TileRenderer lodenRenderer(const runtime::Device& device, const std::string& name, const std::string& setting,
                           const Material& material, Lookup lookup);

// Without and with counted fetches.
struct RendererPrograms {
  runtime::GlProgram plain, counting;
};
// A picture's lambda is the same everywhere, as it nearly is over one object of a scene; a renderer then
// draws with a program that leaves out what is seen in none of `views`.
RendererPrograms compileRenderer(const FullScreen& screen, const TileRenderer& renderer,
                                 std::span<const PlaneView> views, int lights);
// With a program of it. Alpha of a counting one is texture instructions, or the bytes that they read.
enum class Counted { kFetches, kBytes };
void drawRenderer(const FullScreen& screen, const TileRenderer& renderer, const runtime::GlProgram& program,
                  const PlaneView& view, Counted counted = Counted::kFetches);

// Where `uv`, a place of the picture, is declared: plane_point() and towards_eye() of plane_view.h. Every
// fragment text has it; a vertex text that wants it begins with it.
extern const char kPlaneView[];

}  // namespace loden::bench
