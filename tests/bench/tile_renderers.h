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

// The first texture unit that no material takes, and the number of all units that renderers use.
inline constexpr int kFreeUnit = LODEN_MAX_UNITS;
inline constexpr int kUnits = kFreeUnit + BtfTable::kTextures;

// For each texture unit, the bytes of the texels that one texture instruction reads.
class FetchBytes {
 public:
  explicit FetchBytes(const Material& material);
  // Sets the bytes of a unit whose texture is not the material's.
  void setFree(int unit, int texel_bytes, int texels) { bytes_[unit] = float(texel_bytes * texels); }
  const float* data() const { return bytes_; }

 private:
  void set(int unit, const Texture& texture, int texels);
  float bytes_[kUnits] = {};
};

// One way to draw a tile. It has a material system of its own, which tells how many bytes it takes.
struct TileRenderer {
  std::string name, setting;
  std::unique_ptr<runtime::MaterialSystem> materials;
  runtime::MaterialId id;
  FetchBytes fetch_bytes;
  // Body of the fragment shader's main function, which ends with SUM_LIGHTS(value of wi) or SHOW(rgb).
  std::string main;
  std::vector<std::string> defines;  // further ones than those of the material's variant
  bool uses_material = true;         // whether bytes() count the material's
  uint64_t extra_bytes = 0;          // of textures and meshes that the material system does not hold
  // Called before each draw; may be null.
  std::function<void(const runtime::GlProgram&)> prepare;
  // Vertex text, and function that draws; if they are empty and null, a triangle that fills the picture is
  // drawn.
  std::string vertex;
  std::function<void(const PlaneView&)> draw;

  uint64_t bytes() const;
};

// A renderer whose material is whole on the GPU, without `main`.
TileRenderer loadRenderer(const runtime::Device& device, const std::string& name, const std::string& setting,
                          const Material& material, Lookup lookup);
// Draws by Loden's equation, with the given lookup.
TileRenderer lodenRenderer(const runtime::Device& device, const std::string& name, const std::string& setting,
                           const Material& material, Lookup lookup);

// The programs that draw with a renderer; `counting` counts fetches too.
struct RendererPrograms {
  runtime::GlProgram plain, counting;
};
// Compiles programs that leave out what is seen in none of `views`. Lambda is the same all over such a
// picture, as it nearly is over one object of a scene.
RendererPrograms compileRenderer(const FullScreen& screen, const TileRenderer& renderer,
                                 std::span<const PlaneView> views, int lights);
// Draws with one of the renderer's programs. If it is the counting one, alpha is the number of texture
// instructions, or of the bytes that these read.
enum class Counted { kFetches, kBytes };
void drawRenderer(const FullScreen& screen, const TileRenderer& renderer, const runtime::GlProgram& program,
                  const PlaneView& view, Counted counted = Counted::kFetches);

// GLSL text of plane_point() and towards_eye(), which are onPlane and towardsEye of plane_view.h at `uv`, a
// place of the picture that the text before it declares. Fragment texts have it without asking; a vertex text
// that needs it begins with it.
extern const char kPlaneView[];

}  // namespace loden::bench
