// A second reader, written in Python from FORMAT.md alone, must find in a file what the writer was given.
#define XXH_INLINE_ALL
#include <gtest/gtest.h>
#include <unistd.h>
#include <xxhash.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "material/asset/asset.h"
#include "material/system/asset_io.h"
#include "tests/unit/material_fixtures.h"

namespace loden {
namespace {

// Prints a material as independent_reader/read_asset.py prints a file.
class Listing {
 public:
  explicit Listing(const Material& material) {
    listHeader(material);
    for (auto band = material.bands.rbegin(); band != material.bands.rend(); ++band) listBand(*band);
    listMaps(material);
    line("name", material.name);
    auto band = material.bands.rbegin();
    if (band != material.bands.rend() && band->domain == Domain::kReference) listTexels(*band++);
    if (!material.geometry.empty()) listTexels("GEOM", material.geometry.texels);
    if (material.stored_vdim) listTexels("VDIM", material.stored_vdim->reference);
    if (material.stored_vdim) listTexels("VDIM", material.stored_vdim->packed);
    while (band != material.bands.rend()) listTexels(*band++);
    if (material.surface && material.surface->tail_mip > 0)
      listSplit(*material.surface);
    else if (material.surface)
      listMaps(*material.surface);
    if (!material.meta_json.empty()) line("META", hash(material.meta_json.data(), material.meta_json.size()));
  }

  std::string text() const { return text_.str(); }

 private:
  template <class... Values>
  void line(const char* name, const Values&... values) {
    text_ << name;
    ((text_ << ' ' << values), ...);
    text_ << '\n';
  }

  template <class Number>
  static std::string hexadecimal(Number bits) {
    char text[17];
    std::snprintf(text, sizeof text, "%0*llx", static_cast<int>(2 * sizeof bits),
                  static_cast<unsigned long long>(bits));
    return text;
  }
  static void append(std::string& list, const std::string& item) {
    if (!list.empty()) list += ' ';
    list += item;
  }
  static std::string bits(std::initializer_list<float> values) {
    std::string text;
    for (const float value : values) append(text, hexadecimal(std::bit_cast<uint32_t>(value)));
    return text;
  }
  static std::string hash(const void* data, size_t size) {
    return hexadecimal(uint64_t{XXH3_64bits(data, size)});
  }
  template <class Enumeration>
  static uint32_t number(Enumeration value) {
    return static_cast<uint32_t>(value);
  }

  void listHeader(const Material& m) {
    line("mode", number(m.mode));
    line("side", m.side);
    line("levels", bits({m.lambda_min, m.lambda_max}));
    line("value_scale", bits({m.value_scale}), m.cosine_included ? 1 : 0);
    line("theta_max", bits({m.theta_max}));
    line("tile", bits({m.aspect, m.period}));
    const PhongMean& mean = m.mean;
    line("mean", bits({mean.ka, mean.kd, mean.ks, mean.alpha, mean.cb, mean.cr}), number(mean.chroma));
    listDirections("lights", m.lights);
    listDirections("views", m.views);
  }

  void listDirections(const char* name, const DirectionSet& set) {
    std::string samples;
    for (const glm::dvec3& sample : set.samples) {
      for (int axis = 0; axis < 3; ++axis) {
        append(samples, hexadecimal(std::bit_cast<uint64_t>(sample[axis])));
      }
    }
    line(name, number(set.kind), set.side, set.samples.size(), samples);
  }

  void listBand(const Band& band) {
    const Window& w = band.window;
    line("band", bands_++, number(band.domain), number(band.filter), number(band.layout),
         bits({w.in_begin, w.in_end, w.out_begin, w.out_end, band.lambda_first}));
    std::string scales;
    for (const glm::vec4& s : band.quad_scale) append(scales, bits({s.x, s.y, s.z, s.w}));
    for (const QuadLevels& levels : band.quad_levels) append(scales, bits({levels.begin, levels.end}));
    const glm::vec4& ratio = band.ratio_scale;
    line("quads", band.y_quads, band.chroma_quads, band.ratio ? 1 : 0, band.lead_quads,
         bits({ratio.x, ratio.y, ratio.z, ratio.w}), scales);
  }

  void listMaps(const Material& m) {
    if (!m.geometry.empty()) {
      const glm::vec3& range = m.geometry.range;
      line("geometry", m.geometry.side(), bits({range.x, range.y, range.z}),
           m.geometry.identity_parameterization ? 1 : 0, m.atlas.texels, m.atlas.directions);
    }
    if (m.stored_vdim) {
      const PaperVdim& vdim = *m.stored_vdim;
      line("vdim", vdim.side, vdim.zeniths, vdim.azimuths, bits({vdim.range.x, vdim.range.y}));
    }
    if (m.surface)
      line("surface", number(m.surface->lobe), number(m.surface->visibility),
           bits({m.surface->specular_scale, m.surface->lambda_first, m.surface->ambient_first,
                 m.surface->fade_begin, m.surface->fade_end}),
           m.surface->tail_mip);
  }

  void listTexels(const char* chunk, const Texture& t) {
    line(chunk, number(t.format), t.width, t.height, t.depth, t.mips, hash(t.data.data(), t.data.size()));
  }
  void listTexels(const Band& band) {
    if (band.lead_quads > 0) return listSplit(band);
    listTexels("BAND", band.weights);
    listTexels("BAND", band.table);
  }
  static std::vector<const Texture*> texturesOf(const SurfaceMaps& maps) {
    std::vector<const Texture*> textures{&maps.normal, &maps.color, &maps.ambient};
    if (maps.shadow.width > 0) textures.insert(textures.end(), {&maps.shadow, &maps.shadow_table});
    if (maps.indirect.width > 0) textures.push_back(&maps.indirect);
    return textures;
  }
  void listMaps(const SurfaceMaps& maps) {
    for (const Texture* map : texturesOf(maps)) listTexels("SURF", *map);
  }

  // Texels [begin, end) of one mip of a texture, layer by layer, appended to a share's bytes.
  static void appendLayers(const Texture& t, int mip, int begin, int end, std::vector<std::byte>& share) {
    const size_t layer = t.mipBytes(mip) / static_cast<size_t>(t.depth);
    for (size_t z = static_cast<size_t>(begin); z < static_cast<size_t>(end); ++z) {
      const auto from = t.data.begin() + static_cast<ptrdiff_t>(t.mipOffset(mip) + z * layer);
      share.insert(share.end(), from, from + static_cast<ptrdiff_t>(layer));
    }
  }
  void listShare(const char* chunk, const char* what, const std::vector<std::byte>& share) {
    line(chunk, what, share.size(), hash(share.data(), share.size()));
  }
  void listSplit(const Band& band) {
    const int lead = band.lead_quads, quads = band.quads(), slices = band.table.depth / quads;
    std::vector<std::byte> shares[2][2];  // [leading, rest][weights, table]
    for (int mip = 0; mip < band.weights.mips; ++mip) {
      appendLayers(band.weights, mip, 0, lead, shares[0][0]);
      if (band.ratio) appendLayers(band.weights, mip, quads, quads + 1, shares[0][0]);
      appendLayers(band.weights, mip, lead, quads, shares[1][0]);
      appendLayers(band.weights, mip, band.layers(), band.weights.depth, shares[1][0]);
    }
    appendLayers(band.table, 0, 0, lead * slices, shares[0][1]);
    appendLayers(band.table, 0, lead * slices, band.table.depth, shares[1][1]);
    for (const auto& share : shares) {
      listShare("BAND", "weights", share[0]);
      listShare("BAND", "table", share[1]);
    }
  }
  void listSplit(const SurfaceMaps& maps) {
    for (const bool tail : {true, false})
      for (const Texture* map : texturesOf(maps)) {
        std::vector<std::byte> share;
        const float level = maps.lambda_first + float(maps.tail_mip) - maps.ambient_first;
        const bool coarser = map == &maps.ambient || map == &maps.shadow || map == &maps.indirect;
        const int first = map == &maps.shadow_table ? 0
                          : coarser ? std::clamp(int(std::floor(level + 0.5f)), 0, map->mips - 1)
                                    : maps.tail_mip;
        for (int mip = tail ? first : 0; mip < (tail ? map->mips : first); ++mip)
          appendLayers(*map, mip, 0, map->depth, share);
        listShare("SURF", "map", share);
      }
  }

  std::ostringstream text_;
  int bands_ = 0;
};

std::string outputOf(const std::string& command) {
  std::string output;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return output;
  char buffer[4096];
  while (const size_t got = fread(buffer, 1, sizeof buffer, pipe)) output.append(buffer, got);
  pclose(pipe);
  return output;
}

TEST(IndependentReader, FindsWhatTheWriterWasGiven) {
  if (std::system("command -v python3 >/dev/null && command -v zstd >/dev/null") != 0) {
    GTEST_SKIP() << "needs python3 and zstd";
  }
  const std::string script = std::string(LODEN_TESTS_DIR) + "/unit/independent_reader/read_asset.py";
  const auto path =
      std::filesystem::temp_directory_path() / ("loden-reader-" + std::to_string(getpid()) + ".loden");
  for (const auto make : {test::surfaceMaterial, test::lodMaterial, test::fusedMaterial, test::nearMaterial,
                          test::splitSurfaceMaterial, test::splitFusedMaterial}) {
    const Material material = make();
    SCOPED_TRACE(material.name);
    ASSERT_TRUE(writeAsset(material, path).ok());
    EXPECT_EQ(outputOf("python3 -B '" + script + "' '" + path.string() + "' 2>&1"), Listing(material).text());
  }
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace loden
