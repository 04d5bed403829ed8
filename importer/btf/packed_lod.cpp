#include "importer/btf/packed_lod.h"

#include "material/base/issues.h"

namespace loden::importer {
namespace {

constexpr int kQuads = 3;

bool isPublishedForm(const Material& m) {
  if (m.mode != Mode::kLod || m.bands.empty()) return false;
  int side = m.side;
  for (const Band& band : m.bands) {
    if (band.layout != TableLayout::kNearest || band.y_quads != 2 || band.chroma_quads != 1 || band.ratio)
      return false;
    if (band.weights.width != side || side < 1) return false;
    side /= 2;
  }
  return true;
}

Picture emptyPicture(int width, int height) {
  return {width, height, std::vector<glm::vec4>(size_t(width) * size_t(height), glm::vec4(0))};
}

// Products keep their value: the table takes the scale of both.
void packTable(const Band& band, int level, Picture& eigen) {
  const int lights = band.table.width, views = band.table.height;
  for (int quad = 0; quad < kQuads; ++quad)
    for (int v = 0; v < views; ++v)
      for (int l = 0; l < lights; ++l)
        eigen.at(quad * lights + l, level * views + v) =
            fetchTexel(band.table, 0, l, v, quad) * band.quad_scale[size_t(quad)];
}

void packWeights(const Band& band, glm::ivec2 corner, Picture& weights) {
  const int side = band.weights.width;
  for (int quad = 0; quad < kQuads; ++quad)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i)
        weights.at(corner.x + quad % 2 * side + i, corner.y + quad / 2 * side + j) =
            fetchTexel(band.weights, 0, i, j, quad);
}

}  // namespace

Result<PackedLod> packLod(const Material& material) {
  if (!isPublishedForm(material))
    return Issue{issue_id::kOption, Severity::kError, material.name,
                 "is not the published level-of-detail material; cook it with --mode lod --preset seed"};
  const int lights = material.lights.size(), views = material.views.size();
  PackedLod packed{emptyPicture(kQuads * lights, static_cast<int>(material.bands.size()) * views),
                   emptyPicture(2 * material.side, 2 * material.side)};
  glm::ivec2 corner(0);
  for (size_t level = 0; level < material.bands.size(); ++level) {
    const Band& band = material.bands[level];
    packTable(band, static_cast<int>(level), packed.eigen);
    packWeights(band, corner, packed.weights);
    corner += band.weights.width;
  }
  return packed;
}

}  // namespace loden::importer
