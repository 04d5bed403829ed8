// Bytes of every texel's ABRDF as a picture, BTF against Flat-BTF (FBTF table 3), for each way to fill what a
// view does not see. The picture has a column per light and a row per view, 8-bit sRGB, clamped at white; PNG
// at level 9, JPEG at quality 100 without chroma subsampling.
#include <algorithm>
#include <cmath>
#include <functional>
#include <mutex>
#include <optional>

#include "importer/base/parallel.h"
#include "importer/base/picture.h"
#include "importer/base/progress.h"
#include "importer/btf/baked_files.h"
#include "importer/study/figure.h"
#include "importer/study/study.h"
#include "importer/tile/tile_tracer.h"
#include "material/model/color.h"

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

Result<Abrdfs> readSlab(const ViewReader& read, int directions, size_t all_texels, size_t first,
                        size_t texels, int threads) {
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
Result<Bytes> meanBytes(const ViewReader& read, int directions, int side, const StudyOptions& options,
                        const std::string& label) {
  const size_t texels = size_t(side) * side, slab_texels = std::min<size_t>(texels, 16384);
  Progress progress(label, texels, options.quiet);
  std::vector<uint64_t> png(texels), jpeg(texels);
  std::optional<Issue> issue;
  std::mutex issue_mutex;
  for (size_t first = 0; first < texels; first += slab_texels) {
    const auto slab =
        readSlab(read, directions, texels, first, std::min(slab_texels, texels - first), options.threads);
    if (!slab) return slab.issue();
    parallelFor(slab->texels, options.threads, [&](size_t t) {
      const auto image = slab->image(first + t);
      for (const PictureCodec codec : {PictureCodec::kPng, PictureCodec::kJpeg}) {
        const auto bytes = encodeRgb8(image, slab->lights, slab->views, codec);
        const std::lock_guard lock(issue_mutex);
        if (!bytes)
          issue = bytes.issue();
        else
          (codec == PictureCodec::kPng ? png : jpeg)[first + t] = bytes->size();
      }
      progress.advance();
    });
    if (issue) return *issue;
  }
  Bytes mean;
  for (size_t t = 0; t < texels; ++t) mean.png += double(png[t]), mean.jpeg += double(jpeg[t]);
  return Bytes{mean.png / double(texels), mean.jpeg / double(texels)};
}

// FBTF figures 13 and 14: ABRDFs of two texels, a row per view and a column per light. The first is where the
// BTF sees from above what half of all points see of their views, the second what a quarter sees; of the
// Flat-BTF both the parameter that shows the same point of the surface (`point`) and the texel of the same
// number (`texel`).
class AbrdfFigure {
 public:
  AbrdfFigure(const BakedOutput& baked, const std::string& tile, const StudyOptions& options)
      : baked_(baked), tile_(tile), options_(options) {}

  // Chooses the texels.
  Status choose() {
    const auto tile = loadTile(studyTileName(tile_));
    if (!tile) return tile.issue();
    const TileTracer tracer(*tile);
    const BakeManifest& m = baked_.manifest();
    std::vector<int> seen(size_t(m.flat_size) * m.flat_size, 0);
    for (int view = 0; view < m.directions.size(); ++view) {
      const auto visible = baked_.visibleView(view);
      if (!visible) return visible.issue();
      for (size_t t = 0; t < seen.size(); ++t) seen[t] += (*visible)[t] > 0;
    }
    std::vector<Pair> all;
    for (int t = 0; t < m.size * m.size; ++t) {
      const auto hit =
          tracer.intersectView((glm::dvec2(t % m.size, t / m.size) + .5) / double(m.size), {0, 0, 1});
      if (!hit) continue;
      const glm::ivec2 p = glm::ivec2(glm::floor(hit->p * double(m.flat_size))) % m.flat_size;
      const glm::ivec2 cell = (p + m.flat_size) % m.flat_size;
      all.push_back({size_t(t), size_t(cell.y) * m.flat_size + cell.x});
    }
    std::stable_sort(all.begin(), all.end(),
                     [&](const Pair& a, const Pair& b) { return seen[a.point] < seen[b.point]; });
    if (all.empty()) return {};
    pairs_ = {all[all.size() / 2], all[all.size() / 4]};
    return {};
  }

  Status writeBtf() const {
    return write(
        "btf", "texel", [&](int view) { return baked_.btfView(view); }, &Pair::texel, baked_.manifest().size,
        false);
  }
  // What the views do not see is tinted blue.
  Status writeFlat(const BakedOutput& filled, const char* fill) const {
    const auto read = [&](int view) { return filled.flatView(view); };
    const int side = filled.manifest().flat_size;
    if (const Status status = write(std::string("flat-") + fill, "point", read, &Pair::point, side, true);
        !status)
      return status;
    return write(std::string("flat-") + fill, "texel", read, &Pair::texel, side, true);
  }

 private:
  struct Pair {
    size_t texel, point;  // of the BTF; of the Flat-BTF, of the same place of the surface
  };

  Status write(const std::string& kind, const char* what, const ViewReader& read, size_t Pair::*which,
               int side, bool tint) const {
    constexpr int kMagnify = 2;
    const int directions = baked_.manifest().directions.size();
    std::vector<std::vector<glm::vec3>> abrdfs(pairs_.size(),
                                               std::vector<glm::vec3>(size_t(directions) * directions));
    for (int view = 0; view < directions; ++view) {
      const auto values = read(view);
      if (!values) return values.issue();
      const auto visible = tint ? baked_.visibleView(view) : std::vector<float>(size_t(side) * side, 1);
      if (!visible) return visible.issue();
      for (size_t k = 0; k < pairs_.size(); ++k)
        for (int light = 0; light < directions; ++light) {
          const size_t texel = pairs_[k].*which;
          const glm::vec3 value = (*values)[size_t(light) * side * side + texel];
          // The first view, from above, is the top row.
          abrdfs[k][size_t(directions - 1 - view) * directions + light] =
              (*visible)[texel] > 0 ? value : glm::mix(value, glm::vec3(0, 0, .6f), .4f);
        }
    }
    for (size_t k = 0; k < pairs_.size(); ++k) {
      const std::string name =
          "abrdf-size-" + tile_ + "-" + std::to_string(k + 1) + "-" + kind + "-" + what + ".png";
      if (const Status status =
              writeFigure(texelPicture(abrdfs[k], directions, kMagnify), options_.pictures / name);
          !status)
        return status;
    }
    return {};
  }

  const BakedOutput& baked_;
  const std::string& tile_;
  const StudyOptions& options_;
  std::vector<Pair> pairs_;
};

}  // namespace

Result<StudyRows> studyAbrdfSize(const StudyOptions& options) {
  StudyRows rows;
  for (const std::string& tile : options.tiles) {
    const auto baked = studyBake(options, tile);
    if (!baked) return baked.issue();
    const BakeManifest& manifest = baked->manifest();
    const int directions = manifest.directions.size();
    const auto btf = meanBytes([&](int view) { return baked->btfView(view); }, directions, manifest.size,
                               options, "abrdf-size " + tile + " btf");
    if (!btf) return btf.issue();
    AbrdfFigure figure(*baked, tile, options);
    if (!options.pictures.empty()) {
      if (const Status status = figure.choose(); !status) return status.issue();
      if (const Status status = figure.writeBtf(); !status) return status.issue();
    }
    for (const FillMethod fill : {FillMethod::kPushPull, FillMethod::kHarmonic, FillMethod::kNearestView}) {
      StudyBake wanted;
      wanted.fill = fill;
      if (fill != FillMethod::kPushPull)
        wanted.maps = {.btf = false, .flat = true, .vdim = false, .surface = false};
      const auto filled = studyBake(options, tile, wanted);
      if (!filled) return filled.issue();
      const std::string label = "abrdf-size " + tile + " flat " + fillName(fill);
      const auto flat = meanBytes([&](int view) { return filled->flatView(view); }, directions,
                                  manifest.flat_size, options, label);
      if (!flat) return flat.issue();
      if (!options.pictures.empty())
        if (const Status status = figure.writeFlat(*filled, fillName(fill)); !status) return status.issue();
      const auto add = [&](const char* format, double btf_bytes, double flat_bytes) {
        StudyRow row;
        row.set("tile", tile)
            .set("size", manifest.size)
            .set("format", format)
            .set("fill", fillName(fill))
            .set("btf_bytes", btf_bytes);
        rows.push_back(row.set("flat_bytes", flat_bytes).set("ratio", btf_bytes / flat_bytes));
      };
      add("png", btf->png, flat->png);
      add("jpeg", btf->jpeg, flat->jpeg);
    }
  }
  return rows;
}

}  // namespace loden::importer
