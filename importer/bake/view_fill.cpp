#include "importer/bake/view_fill.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <numeric>

#include "importer/base/image_file.h"
#include "importer/base/progress.h"
#include "importer/btf/baked_files.h"

namespace loden::importer {
namespace {

constexpr size_t kMostBytes = size_t(1) << 30;  // of views that are filled together

// For each view and texel the view to copy from: itself where it sees the texel, and where no view does.
// [view][texel].
Result<std::vector<std::vector<uint16_t>>> sourcesOf(const BakedOutput& baked) {
  const auto& directions = baked.manifest().directions.samples;
  std::vector<std::vector<float>> visible;
  for (size_t view = 0; view < directions.size(); ++view) {
    auto mask = baked.visibleView(int(view));
    if (!mask) return mask.issue();
    visible.push_back(std::move(*mask));
  }
  std::vector<std::vector<uint16_t>> sources(directions.size());
  tbb::parallel_for(size_t(0), directions.size(), [&](size_t view) {
    std::vector<uint16_t> nearest(directions.size());
    std::iota(nearest.begin(), nearest.end(), uint16_t(0));
    const auto cosine = [&](uint16_t other) { return glm::dot(directions[other], directions[view]); };
    std::stable_sort(nearest.begin(), nearest.end(),
                     [&](uint16_t a, uint16_t b) { return cosine(a) > cosine(b); });
    sources[view].resize(visible[view].size());
    for (size_t t = 0; t < visible[view].size(); ++t) {
      const auto sees = [&](uint16_t other) { return visible[other][t] > 0; };
      const auto found = std::find_if(nearest.begin(), nearest.end(), sees);
      sources[view][t] = sees(uint16_t(view)) || found == nearest.end() ? uint16_t(view) : *found;
    }
  });
  return sources;
}

Status writeView(const std::filesystem::path& path, const std::vector<glm::vec3>& values, int side,
                 int lights) {
  const AtlasLayout layout = AtlasLayout::forLights(side, lights);
  std::vector<float> pixels(3 * size_t(layout.width()) * size_t(layout.height()));
  for (int l = 0; l < lights; ++l)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i)
        for (int c = 0; c < 3; ++c)
          pixels[3 * layout.pixel(l, i, j) + size_t(c)] =
              values[(size_t(l) * size_t(side) + size_t(j)) * size_t(side) + size_t(i)][c];
  return writeImage(path, layout.width(), layout.height(), 3, PixelType::kHalf, pixels);
}

}  // namespace

Status fillFromViews(const std::filesystem::path& folder, const BakeManifest& manifest, bool quiet) {
  if (!manifest.has_flat || manifest.fill != FillMethod::kNearestView) return {};
  const BakedOutput baked = BakedOutput::unfinished(folder, manifest);
  const auto sources = sourcesOf(baked);
  if (!sources) return sources.issue();
  const int side = manifest.flat_size, views = manifest.directions.size(), lights = views;
  const size_t texels = size_t(side) * size_t(side);
  const int group =
      int(std::clamp<size_t>(kMostBytes / (texels * size_t(lights) * sizeof(glm::vec3)), 1, size_t(views)));
  Progress progress("fill from views", size_t(views), quiet);
  for (int first = 0; first < views; first += group) {
    const int last = std::min(first + group, views);
    std::vector<std::vector<glm::vec3>> filled(size_t(last - first),
                                               std::vector<glm::vec3>(texels * size_t(lights)));
    for (int source = 0; source < views; ++source) {
      const auto values = baked.flatView(source);
      if (!values) return values.issue();
      tbb::parallel_for(first, last, [&](int view) {
        const auto& from = (*sources)[size_t(view)];
        for (size_t t = 0; t < texels; ++t)
          if (from[t] == source)
            for (size_t l = 0; l < size_t(lights); ++l)
              filled[size_t(view - first)][l * texels + t] = (*values)[l * texels + t];
      });
    }
    for (int view = first; view < last; ++view) {
      if (Status status = writeView(flatPath(folder, view), filled[size_t(view - first)], side, lights);
          !status)
        return status;
      progress.advance();
    }
  }
  return {};
}

}  // namespace loden::importer
