// Measured formats: round trips through files written for the purpose, and refusal of broken ones.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "importer/btf/finite_source.h"
#include "importer/btf/measured/bonn_folder.h"
#include "importer/btf/measured/btf_color.h"
#include "importer/btf/measured/btf_file.h"
#include "importer/cook/cook.h"
#include "material/base/issues.h"
#include "tests/unit/btf_writer.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;
using test::BtfWriter;
using test::MemoryBtf;

// Asymmetric in every index, values in [.05, .95]; reciprocal up to the light's cosine if asked for.
MemoryBtf makeBtf(int width, int height, int directions) {
  MemoryBtf btf;
  const DirectionSet bonn = bonn81Directions();
  btf.lights.samples.assign(bonn.samples.begin(), bonn.samples.begin() + directions);
  if (directions == bonn.size()) btf.lights = bonn;
  btf.views = btf.lights;
  btf.width = width, btf.height = height;
  for (int v = 0; v < directions; ++v)
    for (int l = 0; l < directions; ++l)
      for (size_t t = 0; t < btf.texels(); ++t) {
        const float base = 0.5f + 0.45f * std::sin(float(v) * 1.3f + float(l) * 0.7f + float(t) * 2.1f);
        btf.values.emplace_back(base, base * 0.8f, base * 0.5f);
      }
  return btf;
}

class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "loden-measured-XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~TemporaryFolder() { fs::remove_all(path_); }
  fs::path operator/(const char* name) const { return path_ / name; }

 private:
  fs::path path_;
};

Result<std::unique_ptr<MeasuredSource>> openBytes(const TemporaryFolder& folder, const std::string& bytes) {
  std::ofstream(folder / "x.btf", std::ios::binary) << bytes;
  return openBtfFile(folder / "x.btf");
}

void expectSame(const BtfSource& source, const MemoryBtf& btf, float tolerance) {
  ASSERT_EQ(source.size(), glm::ivec2(btf.width, btf.height));
  ASSERT_EQ(source.views().size(), btf.views.size());
  for (int v = 0; v < btf.views.size(); ++v) {
    const auto values = source.view(v);
    ASSERT_TRUE(values.ok()) << values.issue().text;
    float largest = 0;
    for (size_t i = 0; i < values->size(); ++i) {
      const glm::vec3 difference = glm::abs((*values)[i] - btf.values[v * values->size() + i]);
      largest = std::max({largest, difference.x, difference.y, difference.z});
    }
    EXPECT_LE(largest, tolerance) << "view " << v;
  }
}

TEST(BtfFile, EveryKind_ComesBackWithinItsPrecision) {
  const TemporaryFolder folder;
  const MemoryBtf btf = makeBtf(3, 4, 7);
  BtfWriter writer(btf);
  const float half = 1.0f / 2048, single = 1e-6f;  // half has 11 bits below 1
  for (const auto& [bytes, tolerance] : {std::pair{writer.dfmf(2), half},
                                         {writer.dfmf(4), single},
                                         {writer.dfmf(8), single},
                                         {writer.fmf(2), half},
                                         {writer.fmf(4), single},
                                         {writer.pvf(4), single},
                                         {writer.bdi(4), half},
                                         {writer.bdi(3), half}}) {
    const auto source = openBytes(folder, bytes);
    ASSERT_TRUE(source.ok()) << source.issue().text;
    expectSame(**source, btf, tolerance);
    EXPECT_EQ((*source)->cosineFlag(), CosineFlag::kIncluded);
  }
}

TEST(BtfFile, KnownDirections_AreRecognised) {
  const TemporaryFolder folder;
  const MemoryBtf btf = makeBtf(1, 1, 81);
  const auto source = openBytes(folder, BtfWriter(btf).dfmf(4));
  ASSERT_TRUE(source.ok()) << source.issue().text;
  EXPECT_EQ((*source)->lights().kind, DirectionSetKind::kBonn81);
}

TEST(BtfFile, CutAtAnyByte_IsRefused) {
  const TemporaryFolder folder;
  const MemoryBtf btf = makeBtf(2, 2, 3);
  BtfWriter writer(btf);
  for (const std::string& bytes : {writer.dfmf(2), writer.fmf(2), writer.pvf(2), writer.bdi(2)}) {
    for (size_t length = 0; length < bytes.size(); length += length < 700 ? 1 : 7)
      EXPECT_FALSE(openBytes(folder, bytes.substr(0, length)).ok()) << length;
    EXPECT_FALSE(openBytes(folder, bytes + "x").ok());
  }
}

TEST(BtfFile, AnyChangedByteInFront_IsRefusedOrReadWithoutCrash) {
  const TemporaryFolder folder;
  const MemoryBtf btf = makeBtf(2, 2, 3);
  BtfWriter writer(btf);
  for (const std::string& bytes : {writer.dfmf(2), writer.fmf(2), writer.pvf(2), writer.bdi(2)})
    for (size_t at = 0; at < bytes.size(); at += at < 600 ? 1 : 11)
      for (const char flip : {'\xff', '\x80'}) {
        std::string changed = bytes;
        changed[at] = static_cast<char>(changed[at] ^ flip);
        const auto source = openBytes(folder, changed);
        if (source.ok()) (void)(*source)->view(0);
      }
}

TEST(BtfFile, NotANumber_IsRefusedByTheCookWithItsPlaceOrRepaired) {
  const TemporaryFolder folder;
  MemoryBtf btf = makeBtf(4, 4, 3);
  btf.values[btf.texels()].x = std::nanf("");  // view 0, light 1, texel 0
  auto source = openBytes(folder, BtfWriter(btf).bdi(2));
  ASSERT_TRUE(source.ok());
  CookOptions options;
  options.mode = Mode::kLod;
  options.quiet = true;
  const auto refused = cook(**source, options);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.issue().id, issue_id::kNonFinite);
  EXPECT_NE(refused.issue().text.find("1 values"), std::string::npos) << refused.issue().text;
  EXPECT_NE(refused.issue().text.find("view 0, the first at light 1, texel (0, 0)"), std::string::npos)
      << refused.issue().text;
  const auto log = std::make_shared<RepairLog>();
  EXPECT_TRUE(cook(*repairedSource(std::move(*source), log), options).ok());
  EXPECT_EQ(log->count(), 1u);
}

TEST(BtfFile, UnrelatedUseOfTheName_IsRefused) {
  const TemporaryFolder folder;
  EXPECT_FALSE(openBytes(folder, std::string("PK\x03\x04 a zip file of oxrti", 24)).ok());
  EXPECT_FALSE(openBytes(folder, "BTFF").ok());
}

TEST(BtfColor, Models_GiveKnownValues) {
  btf::ColorTransform color;
  color.model = btf::ColorModel::kYuv;
  EXPECT_NEAR(color.rgb({0.5, 0.1, 0.2}).x, 0.5 + 0.2 * 1.13983, 1e-12);
  EXPECT_NEAR(color.rgb({0.5, 0.1, 0.2}).z, 0.5 + 0.1 * 2.03211, 1e-12);
  color.model = btf::ColorModel::kLogYuvRatio;
  EXPECT_NEAR(color.rgb({std::log(0.5 + 1e-5), 0.2, 0}).z, 0.5 + 0.2 * (0.5 + 1e-5) * 2.03211, 1e-9);
  color.model = btf::ColorModel::kLogRgb;
  EXPECT_NEAR(color.rgb(glm::dvec3(std::log(0.3 + 1e-5))).y, 0.3, 1e-12);
  EXPECT_FALSE(btf::isSupported(2));
}

class MemorySource : public MeasuredSource {
 public:
  explicit MemorySource(MemoryBtf btf) : btf_(std::move(btf)) {}
  const std::string& name() const override { return name_; }
  glm::ivec2 size() const override { return {btf_.width, btf_.height}; }
  const DirectionSet& lights() const override { return btf_.lights; }
  const DirectionSet& views() const override { return btf_.views; }
  CosineFlag cosineFlag() const override { return CosineFlag::kNotIncluded; }
  std::string format() const override { return "memory"; }
  Result<std::vector<glm::vec3>> view(int view) const override {
    const size_t count = btf_.texels() * btf_.lights.size();
    return std::vector<glm::vec3>(btf_.values.begin() + view * count,
                                  btf_.values.begin() + (view + 1) * count);
  }

 private:
  std::string name_ = "memory";
  MemoryBtf btf_;
};

TEST(BonnFolder, WrittenAndRead_IsTheSameWithinTheEncoding) {
  const TemporaryFolder folder;
  const MemoryBtf btf = makeBtf(8, 6, 7);
  const MemorySource source(btf);
  // JPEG at quality 100 on a noisy 8 x 6 picture: a few codes of 255 in sRGB; RGBE: 1/256 of the largest
  // channel.
  for (const auto& [encoding, name, tolerance] : {std::tuple{BonnEncoding::kExr, "exr", 1e-6f},
                                                  {BonnEncoding::kHdr, "hdr", 1.0f / 200},
                                                  {BonnEncoding::kJpeg, "jpg", 0.06f}}) {
    ASSERT_TRUE(writeBonnFolder(source, folder / name, encoding, 2, true).ok());
    const auto read = openMeasured(folder / name);
    ASSERT_TRUE(read.ok()) << read.issue().text;
    expectSame(**read, btf, tolerance);
  }
}

TEST(BonnFolder, MissingImage_IsNamed) {
  const TemporaryFolder folder;
  ASSERT_TRUE(
      writeBonnFolder(MemorySource(makeBtf(2, 2, 7)), folder / "set", BonnEncoding::kExr, 2, true).ok());
  fs::remove(folder / "set/tv015_pv060/00015 tl015 pl000 tv015 pv060.exr");
  const auto read = openMeasured(folder / "set");
  ASSERT_FALSE(read.ok());
  EXPECT_NE(read.issue().text.find("lacks 1 images, first tl015 pl000 tv015 pv060"), std::string::npos)
      << read.issue().text;
}

TEST(BonnFolder, Names_AreReadByTheirKeys) {
  const auto plain = parseBonnName("00008 tl000 pl000 tv030 pv030.jpg");
  ASSERT_TRUE(plain);
  EXPECT_NEAR(plain->view.theta, kPi / 6, 1e-12);
  EXPECT_NEAR(plain->view.phi, kPi / 6, 1e-12);
  EXPECT_EQ(plain->light.theta, 0);
  const auto spectral = parseBonnName("TV23.5_PV15_TL7.5_PL350.exr");
  ASSERT_TRUE(spectral);
  EXPECT_NEAR(spectral->view.theta, 23.5 * kPi / 180, 1e-12);
  EXPECT_NEAR(spectral->light.phi, 350 * kPi / 180, 1e-12);
  EXPECT_FALSE(parseBonnName("texture.jpg"));
  EXPECT_FALSE(parseBonnName("tl000 pl000 tv120 pv030.jpg"));
}

TEST(Radiance, AtriumOrder_IsRowsBottomFirst) {
  const TemporaryFolder folder;
  const std::string header = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n";
  const std::string pixels{'\x80', 0, 0,      '\x81', 0,      '\x80', 0,      '\x81',
                           0,      0, '\x80', '\x81', '\x80', '\x80', '\x80', '\x81'};
  std::ofstream(folder / "a.hdr", std::ios::binary) << header << "+X 2 -Y 2\n" << pixels;
  std::ofstream(folder / "b.hdr", std::ios::binary) << header << "-Y 2 +X 2\n" << pixels;
  std::ofstream(folder / "c.hdr", std::ios::binary) << header << "+Y 2 -X 2\n" << pixels;
  std::ofstream(folder / "d.hdr", std::ios::binary) << header << "-Y 2 +X 2\n" << pixels.substr(0, 15);
  const auto a = readRadiance(folder / "a.hdr"), b = readRadiance(folder / "b.hdr");
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_GT(b->at(0, 0).x, 0.9f);
  EXPECT_GT(a->at(0, 1).x, 0.9f);
  EXPECT_EQ(a->at(1, 0), b->at(1, 1));
  EXPECT_FALSE(readRadiance(folder / "c.hdr").ok());
  EXPECT_FALSE(readRadiance(folder / "d.hdr").ok());
}

// f = 1 + a symmetric term: a BRDF; times cos(theta_l): what UBO2014 holds.
MemoryBtf reciprocalBtf(bool cosine) {
  MemoryBtf btf = makeBtf(1, 1, 81);
  for (int v = 0; v < 81; ++v)
    for (int l = 0; l < 81; ++l) {
      const glm::dvec3 wo = btf.views.samples[v], wi = btf.lights.samples[l];
      const double f = 0.3 + 0.5 * std::pow(std::max(0.0, glm::normalize(wi + wo).z), 8);
      btf.values[v * 81 + l] = glm::vec3(float(cosine ? f * wi.z : f));
    }
  return btf;
}

TEST(Reciprocity, TellsWhetherTheCosineIsIn) {
  for (const bool cosine : {false, true}) {
    const auto check = checkReciprocity(MemorySource(reciprocalBtf(cosine)), 2);
    ASSERT_TRUE(check.ok());
    EXPECT_TRUE(check->decisive());
    EXPECT_NEAR(check->slope, cosine ? 1 : 0, 1e-4);
    EXPECT_EQ(check->cosineIncluded(), cosine);
  }
}

TEST(Reciprocity, WithCosine_AddsItOnceAndSaysWhenTheFlagIsWrong) {
  const MemoryBtf with = reciprocalBtf(true);
  for (const bool cosine : {false, true}) {
    std::string note;
    const auto source =
        withCosine(std::make_unique<MemorySource>(reciprocalBtf(cosine)), CosineFlag::kNotIncluded, 2, note);
    ASSERT_TRUE(source.ok());
    expectSame(**source, with, 1e-6f);
    EXPECT_EQ(note.find("flag says otherwise") != std::string::npos, cosine) << note;
  }
}

}  // namespace
}  // namespace loden::importer
