// Streaming and binding of the material system.
#include <epoxy/gl.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>

#include "material/base/issues.h"
#include "material/model/leading_part.h"
#include "runtime/gl/material/gl_texture.h"
#include "runtime/stream/material_data.h"
#include "runtime/stream/material_parts.h"
#include "runtime/stream/streaming.h"
#include "tests/gl/gl_fixture.h"
#include "tests/unit/material_fixtures.h"

namespace loden::test {
namespace {

using namespace runtime;

using MaterialSystemTest = GlTest;

// A fused material whose parts are larger than the floor: 64 x 64 texels, 25 x 36 x 25 directions a quad.
Material largeFused(uint32_t seed) {
  Material material = fusedMaterial();
  material.name = "large";
  material.side = 64;
  material.theta_max = 1.3f;
  for (Band& band : material.bands) {
    const bool flat = band.domain == Domain::kFlat;
    band.weights = noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, flat ? 64 : 32,
                                flat ? 64 : 32, band.layers(), flat ? 1 : 6, seed);
    band.table =
        noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kVolume, 25, 36, 25 * band.quads(), 1, seed + 9);
  }
  return material;
}

// The same whose reference band has a leading part, of one of three quads.
Material splitFused(uint32_t seed) {
  Material material = largeFused(seed);
  Band& band = material.bands[1];
  band.y_quads = 3;
  band.chroma_quads = 0;
  band.ratio = true;
  band.lead_quads = 1;
  band.quad_scale.assign(3, glm::vec4(0.05f, 0.04f, 0.03f, 0.02f));
  band.quad_levels.assign(3, {});
  band.weights = noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kArray2D, 32, 32, 4, 6, seed + 20);
  band.table = noiseTexture(TexelFormat::kRGBA8Snorm, TextureShape::kVolume, 25, 36, 25 * 3, 1, seed + 21);
  return material;
}

// Surface maps of one value each, and that far from the fitted mean.
Material plainSurface() {
  Material material = surfaceMaterial();
  const auto fill = [](Texture& map, const glm::vec4& value) {
    for (int mip = 0; mip < map.mips; ++mip)
      for (int y = 0; y < map.mipHeight(mip); ++y)
        for (int x = 0; x < map.mipWidth(mip); ++x) storeTexel(map, mip, x, y, 0, value);
  };
  fill(material.surface->normal, {0, 0, 0.6f, 0.4f});
  fill(material.surface->color, {0.9f, 0.8f, 0.2f, 0.5f});
  return material;
}

double meanDifference(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i)
    for (int c = 0; c < 3; ++c) sum += std::abs(double(a[i][c]) - double(b[i][c]));
  return sum / double(3 * a.size());
}

// Reads fine until it is told to break.
class BreakableSource final : public ByteSource {
 public:
  explicit BreakableSource(std::shared_ptr<const ByteSource> source) : source_(std::move(source)) {}
  uint64_t size() const override { return source_->size(); }
  Status read(uint64_t offset, std::span<std::byte> into) const override {
    if (mode == kVanished)
      return Issue{issue_id::kCannotRead, Severity::kError, "breakable", "the file is gone"};
    if (Status status = source_->read(offset, into); !status) return status;
    if (mode == kDamaged && !into.empty()) into[into.size() / 2] ^= std::byte{0x40};
    return {};
  }
  enum Mode { kWhole, kVanished, kDamaged };
  std::atomic<Mode> mode{kWhole};

 private:
  std::shared_ptr<const ByteSource> source_;
};

TEST_F(MaterialSystemTest, LoadsWhatIsDemandedAndNothingElse) {
  auto system = makeMaterials();
  const MaterialId id = load(*system, largeFused(1));
  const uint64_t header = system->stats().read_bytes;
  system->update(0.1f);
  EXPECT_EQ(system->stats().uploaded_bytes, 0u) << "nothing was demanded";
  system->demand(id, 3);
  system->finishLoading();
  EXPECT_EQ(system->stats().parts_resident, 1) << "the reference band";
  const uint64_t coarse = system->stats().resident_bytes;
  const uint64_t read = system->stats().read_bytes - header;
  EXPECT_FLOAT_EQ(system->residentLambda(id), 2);
  system->demand(id, 0);
  system->finishLoading();
  EXPECT_EQ(system->stats().parts_resident, 4)
      << "and geometry with a small atlas, the flat band, the full atlas";
  EXPECT_EQ(system->residentLambda(id), 0);
  EXPECT_GT(system->stats().resident_bytes, coarse);
  EXPECT_GT(system->stats().read_bytes - header, read);
  EXPECT_EQ(system->stats().resident_bytes, system->stats().total_bytes);
}

TEST_F(MaterialSystemTest, DrawsEveryMode) {
  auto system = makeMaterials();
  for (const Material& material : {surfaceMaterial(), lodMaterial(), fusedMaterial()}) {
    const MaterialId id = load(*system, material);
    system->demand(id, 0);
    system->finishLoading();
    const std::vector<glm::vec4> pixels = drawMaterial(*system, id, 0);
    float low = 1e9f, high = -1e9f;
    for (const glm::vec4& pixel : pixels) {
      ASSERT_TRUE(std::isfinite(pixel.x + pixel.y + pixel.z)) << material.name;
      low = std::min(low, pixel.y);
      high = std::max(high, pixel.y);
      EXPECT_EQ(pixel.w, 0) << "lambda";
    }
    EXPECT_GT(high - low, 0.01f) << material.name << " shows no texture";
  }
}

TEST_F(MaterialSystemTest, ClampsLambdaToWhatIsResident) {
  auto system = makeMaterials();
  const MaterialId id = load(*system, largeFused(2));
  system->demand(id, 3);
  system->finishLoading();
  for (const glm::vec4& pixel : drawMaterial(*system, id, 0.5f)) ASSERT_EQ(pixel.w, 2);
}

TEST_F(MaterialSystemTest, ShowsTheMeanBeforeAnythingIsResident) {
  auto system = makeMaterials({.budget_bytes = 0});
  for (const Material& material : {surfaceMaterial(), lodMaterial(), fusedMaterial()}) {
    const MaterialId id = load(*system, material);
    system->demand(id, 0);
    system->finishLoading();
    EXPECT_EQ(system->stats().resident_bytes, 0u);
    const std::vector<glm::vec4> pixels = drawMaterial(*system, id, 0);
    EXPECT_GT(pixels[0].y, 0.05f) << material.name;
    for (const glm::vec4& pixel : pixels) ASSERT_EQ(pixel, pixels[0]) << material.name;
  }
}

TEST_F(MaterialSystemTest, UploadsARowAFrameWithoutAnUploadBound) {
  auto system = makeMaterials({.upload_bytes_per_frame = 0});
  const MaterialId id = load(*system, fusedMaterial());
  system->demand(id, 0);
  system->finishLoading();
  EXPECT_EQ(system->residentLambda(id), 0);
}

TEST_F(MaterialSystemTest, RefusesOptionsThatCannotWork) {
  for (const float fade : {0.0f, -1.0f, std::nanf("")}) {
    const auto system = MaterialSystem::create(*device, {.fade_levels_per_second = fade});
    ASSERT_FALSE(system.ok());
    EXPECT_EQ(system.issue().id, issue_id::kOption);
  }
}

// What cast shadows come from: the asset's own way, at most what is wanted; the map where there is one and
// either asks for it.
TEST_F(MaterialSystemTest, FindsVisibilityByWhatTheAssetHolds) {
  using enum Visibility;
  Material with_map = test::nearMaterial();
  const auto shown = [](const Material& m, Visibility wanted, Lookup lookup = Lookup::kDefault) {
    const auto variant = materialVariant(m, lookup, wanted);
    EXPECT_TRUE(variant.ok());
    EXPECT_EQ(variant->shadow_quads, variant->visibility == kMap ? m.surface->shadow.depth : 0);
    return variant->visibility;
  };
  for (const Visibility own : {kFast, kDefault, kMap}) {
    with_map.surface->visibility = own;
    EXPECT_EQ(shown(with_map, kNone), kNone);
    EXPECT_EQ(shown(with_map, kMap), kMap);
    EXPECT_EQ(shown(with_map, kMap, Lookup::kNone), kMap) << "read at x";
    EXPECT_EQ(shown(with_map, kDefault), own);
    EXPECT_EQ(shown(with_map, kFast), own == kMap ? kMap : kFast);
    EXPECT_EQ(shown(with_map, kDefault, Lookup::kFast), own == kMap ? kMap : kFast);
    if (own == kMap) continue;
    Material without = with_map;
    without.surface = withoutShadow(*with_map.surface);
    EXPECT_EQ(shown(without, kMap), kFast);
    EXPECT_EQ(shown(without, kDefault), own);
    EXPECT_EQ(shown(without, kDefault, Lookup::kNone), kNone);
  }
  with_map.surface->visibility = kNone;
  EXPECT_EQ(shown(with_map, kMap), kNone) << "shadows that the asset does not have";
}

TEST_F(MaterialSystemTest, ComparesEveryTextureWithTheDriversLimits) {
  for (const Material& material : {surfaceMaterial(), lodMaterial(), fusedMaterial()}) {
    const Result<MaterialVariant> variant = materialVariant(material, Lookup::kDefault);
    ASSERT_TRUE(variant.ok());
    const std::vector<PartPlan> parts = planParts(material, *variant, {});
    EXPECT_TRUE(checkExtents(material, parts, device->capabilities()).ok());
    for (int Capabilities::*limit : {&Capabilities::max_texture_side, &Capabilities::max_array_layers}) {
      Capabilities small = device->capabilities();
      small.*limit = 0;
      const Status status = checkExtents(material, parts, small);
      ASSERT_FALSE(status.ok()) << material.name;
      EXPECT_EQ(status.issue().id, issue_id::kLimit);
    }
    Capabilities no_volumes = device->capabilities();
    no_volumes.max_volume_side = 1;
    EXPECT_EQ(checkExtents(material, parts, no_volumes).ok(), material.bands.empty()) << material.name;
  }
}

TEST_F(MaterialSystemTest, FarAwayTheLeadingQuadsAreEnough) {
  Material material = splitFused(5);
  material.bands[1].quad_levels = {{}, {-kNoEnd, 4}, {-kNoEnd, 3}};
  auto system = makeMaterials();
  const MaterialId id = load(*system, material);
  system->demand(id, 4);
  system->finishLoading();
  const uint64_t lead = gpuBytes(leadOf(material.bands[1]));
  EXPECT_EQ(system->stats().resident_bytes, lead);
  system->demand(id, 3.5f);
  system->finishLoading();
  EXPECT_EQ(system->stats().resident_bytes, lead + gpuBytes(material.bands[1]));
}

TEST_F(MaterialSystemTest, ObeysABudgetThatChanges) {
  auto system = makeMaterials();
  const MaterialId id = load(*system, largeFused(3));
  system->demand(id, 0);
  system->finishLoading();
  const uint64_t all = system->stats().resident_bytes;
  system->setBudget(all / 2);
  for (int frame = 0; frame < 3; ++frame) {
    system->demand(id, 0);
    system->update(1.0f / 60);
    EXPECT_LE(system->stats().resident_bytes, all / 2);
  }
  system->setBudget(2 * all);
  system->demand(id, 0);
  system->finishLoading();
  EXPECT_EQ(system->stats().resident_bytes, all);
}

// As an engine has it that owns its context.
TEST_F(MaterialSystemTest, WorksInAContextOfSomebodyElse) {
  auto own = makeMaterials();
  const MaterialId own_id = load(*own, largeFused(4));
  own->demand(own_id, 0);
  own->finishLoading();
  const auto expected = drawMaterial(*own, own_id, 0);

  DeviceOptions options;
  options.kind = DeviceKind::kCurrent;
  const Result<std::unique_ptr<Device>> current = Device::create(options);
  ASSERT_TRUE(current.ok()) << current.issue().text;
  const Result<std::unique_ptr<MaterialSystem>> system = MaterialSystem::create(**current, {});
  ASSERT_TRUE(system.ok()) << system.issue().text;
  const MaterialId id = load(**system, largeFused(4));
  (*system)->demand(id, 0);
  (*system)->finishLoading();
  EXPECT_EQ(drawMaterial(**system, id, 0), expected);
}

TEST_F(MaterialSystemTest, StaysWithinBudgetAndUploadBoundOnEveryFrame) {
  for (const uint64_t budget : {300u << 10, 1u << 20, 8u << 20}) {
    auto system = makeMaterials({.budget_bytes = budget, .upload_bytes_per_frame = 20 << 10});
    std::vector<MaterialId> ids;
    for (uint32_t i = 0; i < 6; ++i) ids.push_back(load(*system, largeFused(10 + i)));
    // At least forty frames for each; on a slow machine as many more as it takes until the first part
    // arrives.
    for (int frame = 0; frame < 240 || (system->stats().uploaded_bytes == 0 && frame < 1000000); ++frame) {
      system->demand(ids[size_t(frame / 40) % ids.size()], 0);
      system->update(1.0f / 60);
      ASSERT_LE(system->stats().resident_bytes, budget);
      // One row, of 128 texels of 8 bytes at most, may exceed what is left of the bound.
      ASSERT_LE(system->stats().uploaded_last_frame, (20u << 10) + 1024);
      // Frames take time; without, the demand would be elsewhere each time before a part is read.
      std::this_thread::sleep_for(std::chrono::microseconds(300));
    }
    EXPECT_GT(system->stats().uploaded_bytes, 0u);
  }
}

TEST_F(MaterialSystemTest, FadesInWithoutAPop) {
  for (const Material& material : {largeFused(3), splitFused(3), plainSurface()}) {
    auto system = makeMaterials();
    const MaterialId id = load(*system, material);
    std::vector<glm::vec4> before = drawMaterial(*system, id, 0, {16, 16});
    const std::vector<glm::vec4> first = before;
    double largest = 0;
    for (int frame = 0; frame < 4000; ++frame) {
      system->demand(id, 0);
      system->update(1.0f / 60);
      std::vector<glm::vec4> now = drawMaterial(*system, id, 0, {16, 16});
      largest = std::max(largest, meanDifference(before, now));
      before = std::move(now);
      if (system->residentLambda(id) == 0) break;
    }
    EXPECT_EQ(system->residentLambda(id), 0);
    EXPECT_LT(largest, 0.2 * meanDifference(first, before))
        << material.name << ": one frame brings more than a fifth of the whole change";
  }
}

TEST_F(MaterialSystemTest, ShowsAtOnceWhatArrivedUnseen) {
  auto system = makeMaterials();
  const MaterialId id = load(*system, fusedMaterial());  // its reference band fits into the floor
  for (int frame = 0; frame < 10000 && system->stats().parts_resident < 1; ++frame) {
    system->update(1.0f / 60);
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  system->demand(id, 0);
  system->update(1.0f / 60);
  EXPECT_EQ(system->residentLambda(id), 2);
}

TEST_F(MaterialSystemTest, DrawsWithASmallAtlasWhereThereIsNoRoomForTheFullOne) {
  auto small = makeMaterials({.atlas_size = kFirstVdimAtlas});
  const MaterialId a = load(*small, largeFused(6));
  small->demand(a, 0);
  small->finishLoading();
  EXPECT_EQ(small->stats().parts_resident, 3);
  const std::vector<glm::vec4> with_small = drawMaterial(*small, a, 0);

  auto tight = makeMaterials({.budget_bytes = small->stats().resident_bytes + 1000});
  const MaterialId b = load(*tight, largeFused(6));
  tight->demand(b, 0);
  tight->finishLoading();
  EXPECT_EQ(tight->residentLambda(b), 0);
  EXPECT_TRUE(drawMaterial(*tight, b, 0) == with_small);
  EXPECT_GT(tight->stats().total_bytes, tight->stats().resident_bytes);
}

TEST_F(MaterialSystemTest, BuildsTheAtlasThatTheAssetAsksForUnlessToldOtherwise) {
  Material asking = largeFused(6);
  asking.atlas = {20, 14};
  auto by_asset = makeMaterials(), by_caller = makeMaterials({.atlas_size = VdimAtlasSize{20, 14}});
  const MaterialId a = load(*by_asset, asking), b = load(*by_caller, largeFused(6));
  for (const auto& [system, id] : {std::pair{by_asset.get(), a}, {by_caller.get(), b}}) {
    system->demand(id, 0);
    system->finishLoading();
  }
  EXPECT_EQ(by_asset->material(a).atlas, asking.atlas);
  EXPECT_EQ(by_asset->stats().total_bytes, by_caller->stats().total_bytes);
  EXPECT_TRUE(drawMaterial(*by_asset, a, 0) == drawMaterial(*by_caller, b, 0));
  auto usual = makeMaterials();
  load(*usual, largeFused(6));
  EXPECT_EQ(usual->stats().total_bytes - by_asset->stats().total_bytes,
            vdimDepthBytes(largeFused(6).atlas) - vdimDepthBytes(asking.atlas));
}

TEST_F(MaterialSystemTest, FallsBackToTheSmallAtlasWhenTheFullOneGoes) {
  auto small = makeMaterials({.atlas_size = kFirstVdimAtlas}), system = makeMaterials({.release_seconds = 1});
  const MaterialId a = load(*small, largeFused(6)), b = load(*system, largeFused(6));
  small->demand(a, 0);
  small->finishLoading();
  system->demand(b, 0);
  system->finishLoading();
  EXPECT_EQ(system->stats().parts_resident, 4);
  const uint64_t revision = system->reliefRevision();
  for (int frame = 0; frame < 5; ++frame) {
    system->demand(b, 1.5f);  // bands and geometry, but not so near that the full atlas would show
    system->update(0.5f);
  }
  EXPECT_EQ(system->stats().parts_resident, 3);
  EXPECT_NE(system->reliefRevision(), revision);
  EXPECT_TRUE(drawMaterial(*system, b, 0) == drawMaterial(*small, a, 0));
  system->demand(b, 0);
  system->finishLoading();
  EXPECT_EQ(system->stats().parts_resident, 4) << "and it comes back";
}

// Of what is split, the leading part as if nothing else were stored, the whole as if it were not split.
TEST_F(MaterialSystemTest, ShowsALeadingPartUntilTheWholeIsThereAndAgainWhenItGoes) {
  const Material split = splitFused(31);
  Material lead = split, unsplit = split;
  lead.bands[1] = leadOf(split.bands[1]);
  unsplit.bands[1].lead_quads = 0;
  const auto picture = [this](const Material& material) {
    auto system = makeMaterials();
    const MaterialId id = load(*system, material);
    system->demand(id, 2.5f);
    system->finishLoading();
    return drawMaterial(*system, id, 2.5f);
  };
  const std::vector<glm::vec4> with_lead = picture(lead), with_whole = picture(unsplit);
  EXPECT_GT(meanDifference(with_lead, with_whole), 1e-3);

  auto system = makeMaterials({.release_seconds = 1});
  const MaterialId id = load(*system, split);
  system->demand(id, 2.5f);
  system->finishLoading();
  EXPECT_EQ(system->stats().parts_resident, 2);
  EXPECT_TRUE(drawMaterial(*system, id, 2.5f) == with_whole);
  auto tight = makeMaterials({.budget_bytes = gpuBytes(lead.bands[1]) + 1000});
  const MaterialId small = load(*tight, split);
  tight->demand(small, 2.5f);
  tight->finishLoading();
  EXPECT_EQ(tight->stats().parts_resident, 1);
  EXPECT_EQ(tight->residentLambda(small), 2) << "the whole is no finer level";
  EXPECT_TRUE(drawMaterial(*tight, small, 2.5f) == with_lead);
}

TEST_F(MaterialSystemTest, ShowsTheTailOfSurfaceMapsUntilTheyAreThere) {
  Material split = splitSurfaceMaterial();
  split.geometry = {};  // nothing to be missing but the maps
  split.stored_vdim.reset();
  Material unsplit = split;
  unsplit.surface->tail_mip = 0;
  auto whole = makeMaterials(), system = makeMaterials(),
       tight = makeMaterials({.budget_bytes = gpuBytes(leadOf(*split.surface)) + 10});
  const MaterialId a = load(*whole, unsplit), b = load(*system, split), c = load(*tight, split);
  whole->demand(a, 0);
  whole->finishLoading();
  tight->demand(c, 0);
  tight->finishLoading();
  EXPECT_EQ(tight->residentLambda(c), 2);
  EXPECT_TRUE(drawMaterial(*tight, c, 0) == drawMaterial(*whole, a, 2));
  system->demand(b, 0);
  system->finishLoading();
  EXPECT_EQ(system->residentLambda(b), 0);
  EXPECT_TRUE(drawMaterial(*system, b, 0) == drawMaterial(*whole, a, 0));
}

TEST_F(MaterialSystemTest, ReadsEveryPartOnce) {
  for (const Material& material : {largeFused(7), splitFused(8), splitSurfaceMaterial()}) {
    const std::shared_ptr<const ByteSource> source = assetSource(material);
    auto system = makeMaterials();
    Result<MaterialId> id = system->load(source, "once");
    ASSERT_TRUE(id.ok());
    system->demand(*id, 0);
    system->finishLoading();
    std::atomic<uint64_t> opened{0};
    Result<AssetFile> file = AssetFile::open(std::make_shared<CountingSource>(source, opened), "once");
    ASSERT_TRUE(file.ok());
    uint64_t stored = 0;
    for (const MaterialPart& part : materialParts(material))
      if (part.kind != PartKind::kStoredVdim) stored += file->storedBytes(part);
    EXPECT_EQ(system->stats().read_bytes - opened, stored)
        << material.name
        << ": the full atlas is built from the image that the small one was built from, the whole from its "
           "leading part";
  }
}

TEST_F(MaterialSystemTest, KeepsTheCoarseLevelIfTheFileBreaks) {
  for (const BreakableSource::Mode mode : {BreakableSource::kVanished, BreakableSource::kDamaged}) {
    messages.clear();
    auto system = makeMaterials();
    auto source = std::make_shared<BreakableSource>(assetSource(largeFused(4)));
    Result<MaterialId> id = system->load(source, "breakable");
    ASSERT_TRUE(id.ok());
    system->demand(*id, 3);
    system->finishLoading();
    source->mode = mode;
    system->demand(*id, 0);
    system->finishLoading();
    EXPECT_EQ(system->residentLambda(*id), 2);
    EXPECT_EQ(system->stats().failed_parts, 2u)
        << "geometry and flat band were both asked for, the full atlas was not";
    ASSERT_EQ(messages.size(), 2u);
    EXPECT_EQ(messages[0].severity, Severity::kWarning);
    EXPECT_EQ(messages[0].id,
              mode == BreakableSource::kVanished ? issue_id::kCannotRead : issue_id::kChunkChecksum);
    EXPECT_GT(drawMaterial(*system, *id, 0)[0].y, 0);
  }
  messages.clear();
}

TEST_F(MaterialSystemTest, NoticesThatTheDriverHasNoMemory) {
  const Capabilities& gl = device->capabilities();
  PartTexture part{0, Sampling::kRepeatNearest, false, "huge", {}};
  part.texels.format = TexelFormat::kRGBA32Sfloat;
  part.texels.shape = TextureShape::kArray2D;
  part.texels.width = part.texels.height = gl.max_texture_side;
  part.texels.depth = gl.max_array_layers;  // terabytes
  part.texels.mips = 1;
  EXPECT_FALSE(allocateTexture(part, "huge"));
  while (glGetError() != GL_NO_ERROR) {
  }
  messages.clear();  // the driver may say so too
  part.texels.width = part.texels.height = part.texels.depth = 4;
  EXPECT_TRUE(allocateTexture(part, "small"));
}

TEST_F(MaterialSystemTest, UnloadsWhileLoading) {
  auto system = makeMaterials({.upload_bytes_per_frame = 4096});
  for (int i = 0; i < 10; ++i) {
    const MaterialId id = load(*system, largeFused(5));
    for (int frame = 0; frame < i; ++frame) {
      system->demand(id, 0);
      system->update(1.0f / 60);
    }
    system->unload(id);
  }
  system->update(1.0f / 60);
  EXPECT_EQ(system->stats().materials, 0);
  EXPECT_EQ(system->stats().total_bytes, 0u);
  EXPECT_EQ(system->stats().resident_bytes, 0u);
}

TEST_F(MaterialSystemTest, RefusesWhatIsNoAsset) {
  auto system = makeMaterials();
  const Result<MaterialId> id = system->load(memorySource(std::vector<std::byte>(100), "zeros"), "zeros");
  ASSERT_FALSE(id.ok());
  EXPECT_EQ(id.issue().id, issue_id::kMagic);
  EXPECT_FALSE(system->load("/no/such/file.loden").ok());
}

}  // namespace
}  // namespace loden::test
