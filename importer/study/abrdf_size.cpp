// Bytes of every texel's ABRDF as a picture, BTF against Flat-BTF (FBTF table 3), for each way to fill what a view
// does not see. The picture has a column per
// light and a row per view, 8-bit sRGB, clamped at white; PNG at level 9, JPEG at quality 100 without chroma
// subsampling.
#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <optional>

#include "importer/baked_files.h"
#include "importer/parallel.h"
#include "importer/picture.h"
#include "importer/progress.h"
#include "importer/study/study.h"
#include "material/color.h"

namespace loden::importer {
namespace {

uint8_t srgbCode(float linear) {
  return static_cast<uint8_t>(std::lround(srgbFromLinear(std::clamp(double(linear), 0.0, 1.0)) * 255));
}

// All ABRDFs of a BTF as [texel][view][light] RGB: at 256 x 256 that is 1.3 GB, so texels go in slabs.
struct Abrdfs {
  int views = 0, lights = 0;
  size_t first = 0, texels = 0;  // the slab
  std::vector<uint8_t> rgb;
  std::vector<uint8_t> image(size_t texel) const {
    const size_t bytes = size_t(views) * lights * 3;
    const auto begin = rgb.begin() + static_cast<ptrdiff_t>((texel - first) * bytes);
    return {begin, begin + static_cast<ptrdiff_t>(bytes)};
  }
};

using ViewReader = std::function<Result<std::vector<glm::vec3>>(int view)>;

Result<Abrdfs> readSlab(const ViewReader& read, int directions, size_t all_texels, size_t first, size_t texels, int threads) {
  Abrdfs slab{directions, directions, first, texels, {}};
  slab.rgb.resize(texels * directions * directions * 3);
  for (int view = 0; view < directions; ++view) {
    const auto values = read(view);
    if (!values) return values.issue();
    parallelFor(texels, threads, [&](size_t t) {
      uint8_t* out = &slab.rgb[(t * directions + view) * directions * 3];
      for (int light = 0; light < directions; ++light)
        for (int c = 0; c < 3; ++c) *out++ = srgbCode((*values)[light * all_texels + first + t][c]);
    });
  }
  return slab;
}

struct Bytes {
  double png = 0, jpeg = 0;
};

// Mean over all texels of the two files' sizes.
Result<Bytes> meanBytes(const ViewReader& read, int directions, int side, const StudyOptions& options, const std::string& label) {
  const size_t texels = size_t(side) * side, slab_texels = std::min<size_t>(texels, 16384);
  Progress progress(label, texels, options.quiet);
  std::vector<uint64_t> png(texels), jpeg(texels);
  std::optional<Issue> issue;
  std::mutex issue_mutex;
  for (size_t first = 0; first < texels; first += slab_texels) {
    const auto slab = readSlab(read, directions, texels, first, std::min(slab_texels, texels - first), options.threads);
    if (!slab) return slab.issue();
    parallelFor(slab->texels, options.threads, [&](size_t t) {
      const auto image = slab->image(first + t);
      for (const PictureCodec codec : {PictureCodec::kPng, PictureCodec::kJpeg}) {
        const auto bytes = encodeRgb8(image, slab->lights, slab->views, codec);
        const std::lock_guard lock(issue_mutex);
        if (!bytes) issue = bytes.issue();
        else (codec == PictureCodec::kPng ? png : jpeg)[first + t] = bytes->size();
      }
      progress.advance();
    });
    if (issue) return *issue;
  }
  Bytes mean;
  for (size_t t = 0; t < texels; ++t) mean.png += double(png[t]), mean.jpeg += double(jpeg[t]);
  return Bytes{mean.png / double(texels), mean.jpeg / double(texels)};
}

}  // namespace

Result<StudyRows> studyAbrdfSize(const StudyOptions& options) {
  StudyRows rows;
  for (const std::string& tile : options.tiles) {
    const auto baked = studyBake(options, tile);
    if (!baked) return baked.issue();
    const BakeManifest& manifest = baked->manifest();
    const int directions = manifest.directions.size();
    const auto btf = meanBytes([&](int view) { return baked->btfView(view); }, directions, manifest.size, options, "abrdf-size " + tile + " btf");
    if (!btf) return btf.issue();
    for (const FillMethod fill : {FillMethod::kPushPull, FillMethod::kHarmonic, FillMethod::kNearestView}) {
      StudyBake wanted;
      wanted.fill = fill;
      if (fill != FillMethod::kPushPull) wanted.maps = {.btf = false, .flat = true, .vdim = false, .surface = false};
      const auto filled = studyBake(options, tile, wanted);
      if (!filled) return filled.issue();
      const std::string label = "abrdf-size " + tile + " flat " + fillName(fill);
      const auto flat = meanBytes([&](int view) { return filled->flatView(view); }, directions, manifest.flat_size, options, label);
      if (!flat) return flat.issue();
      const auto add = [&](const char* format, double btf_bytes, double flat_bytes) {
        StudyRow row;
        row.set("tile", tile).set("size", manifest.size).set("format", format).set("fill", fillName(fill)).set("btf_bytes", btf_bytes);
        rows.push_back(row.set("flat_bytes", flat_bytes).set("ratio", btf_bytes / flat_bytes));
      };
      add("png", btf->png, flat->png);
      add("jpeg", btf->jpeg, flat->jpeg);
    }
  }
  return rows;
}

}  // namespace loden::importer
