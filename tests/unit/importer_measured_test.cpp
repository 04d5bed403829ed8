// Measured formats: round trips through files written for the purpose, and refusal of broken ones.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "importer/btf/finite_source.h"
#include "importer/btf/measured/bonn_folder.h"
#include "importer/btf/measured/btf_color.h"
#include "importer/btf/measured/btf_file.h"
#include "importer/btf/measured/cropped_source.h"
#include "importer/btf/measured/mapped_file.h"
#include "importer/cook/cook.h"
#include "material/base/issues.h"
#include "tests/unit/btf_writer.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;
using test::BtfFormat;
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

void expectReads(const std::string& bytes, const MemoryBtf& btf, float tolerance, const char* what) {
  SCOPED_TRACE(what);
  const TemporaryFolder folder;
  const auto source = openBytes(folder, bytes);
  ASSERT_TRUE(source.ok()) << source.issue().text;
  expectSame(**source, btf, tolerance);
}

// The message must hold `text`.
void expectRefused(const std::string& bytes, int id, const std::string& text) {
  const TemporaryFolder folder;
  const auto source = openBytes(folder, bytes);
  ASSERT_FALSE(source.ok()) << text;
  EXPECT_EQ(source.issue().id, id) << source.issue().text;
  EXPECT_NE(source.issue().text.find(text), std::string::npos) << source.issue().text;
  EXPECT_NE(source.issue().where.find("x.btf"), std::string::npos);
}

constexpr float kHalf = 1.0f / 2048, kSingle = 1e-6f;  // a half has 11 bits below 1

TEST(BtfFile, EveryKind_ComesBackWithinItsPrecision) {
  const MemoryBtf btf = makeBtf(3, 4, 7);
  const auto written = [&](BtfFormat format) { return BtfWriter(btf, std::move(format)); };
  for (const auto& [scalar_size, tolerance] :
       {std::pair<uint8_t, float>{2, kHalf}, {4, kSingle}, {8, kSingle}})
    for (const bool stacked : {false, true}) {
      BtfFormat format;
      format.scalar_size = scalar_size;
      format.images_stacked = stacked;
      expectReads(written(format).dfmf(), btf, tolerance, "DFMF");
      expectReads(written(format).fmf(), btf, tolerance, "FMF");
      expectReads(written(format).pvf(), btf, 2 * tolerance, "PVF");  // the mean is rounded, too
      format.legacy = true;
      expectReads(written(format).pvf(), btf, 2 * tolerance, "legacy PVF");
    }
}

// Logarithms of values above .02 are at most 4 in size: a half has an error of 1/1024 there.
TEST(BtfFile, DynamicRange_IsRestored) {
  const MemoryBtf btf = makeBtf(3, 4, 7);
  for (const uint8_t version : {uint8_t{1}, uint8_t{2}}) {
    BtfFormat format;
    format.header_version = version;
    expectReads(BtfWriter(btf, format).fmf12(), btf, 1.0f / 1024, "FMF12");
  }
}

TEST(BtfFile, ChannelsOfADfmf_HaveTheirOwnNumbersOfComponents) {
  const MemoryBtf btf = makeBtf(2, 4, 7);
  BtfFormat format;
  format.more_components[0] = 0, format.more_components[1] = 8, format.more_components[2] = 32;  // 8, 16, 40
  expectReads(BtfWriter(btf, format).dfmf(), btf, kHalf, "8, 16 and 40 components");
}

TEST(BtfFile, ColourModels_ComeBack) {
  const MemoryBtf btf = makeBtf(3, 4, 7);
  for (const int32_t model : {0, 4, 11}) {
    BtfFormat format;
    format.color_model = model;
    format.scalar_size = 4;
    expectReads(BtfWriter(btf, format).dfmf(), btf, 4e-6f, "model");
  }
  BtfFormat format;
  format.color_model = 2;
  expectRefused(BtfWriter(btf, format).dfmf(), issue_id::kVersion, "colour model 2, Lab");
}

// What tests/fuzz/btf_fuzz.cpp begins with. After a change of the writer, write the files anew:
//   LODEN_WRITE_SEEDS=1 unit_importer --gtest_filter='FuzzSeeds.*'
TEST(FuzzSeeds, AreMeasuredBtfsOfEveryKind) {
  const MemoryBtf btf = makeBtf(2, 3, 3);
  BtfFormat plain, stacked, legacy, filled;
  stacked.images_stacked = true, stacked.color_model = 11;
  legacy.legacy = true;
  filled.last_chunk_filled = true;
  const std::pair<const char*, std::string> seeds[] = {
      {"dfmf.btf", BtfWriter(btf, plain).dfmf()}, {"dfmf_stacked.btf", BtfWriter(btf, stacked).dfmf()},
      {"fmf.btf", BtfWriter(btf, plain).fmf()},   {"fmf12.btf", BtfWriter(btf, plain).fmf12()},
      {"pvf.btf", BtfWriter(btf, plain).pvf()},   {"pvf_legacy.btf", BtfWriter(btf, legacy).pvf()},
      {"bdi.btf", BtfWriter(btf, plain).bdi()},   {"bdi_filled.btf", BtfWriter(btf, filled).bdi()},
  };
  for (const auto& [name, bytes] : seeds) {
    SCOPED_TRACE(name);
    const std::string path = std::string(LODEN_TESTS_DIR) + "/fuzz/corpus/btf_fuzz/" + name;
    if (std::getenv("LODEN_WRITE_SEEDS") != nullptr) std::ofstream(path, std::ios::binary) << bytes;
    const auto source = openBtfFile(path);
    ASSERT_TRUE(source.ok()) << source.issue().text;
    std::ostringstream stored;
    stored << std::ifstream(path, std::ios::binary).rdbuf();
    EXPECT_EQ(stored.str(), bytes);
  }
}

// What the files of UBO2014 are: 151 x 151 directions, halves, model 11, the cosine in them.
TEST(BtfFile, FileLikeThoseOfUbo2014_IsReadWithItsDirections) {
  MemoryBtf btf;
  btf.lights = btf.views = ubo151Directions();
  btf.width = btf.height = 2;
  for (int v = 0; v < 151; ++v)
    for (int l = 0; l < 151; ++l)
      for (int t = 0; t < 4; ++t) {
        const auto cosine = static_cast<float>(btf.lights.samples[l].z);
        btf.values.push_back(cosine * glm::vec3(.4f, .3f, .2f) * (1 + .1f * std::sin(float(v + t))));
      }
  BtfFormat format;
  format.color_model = 11;
  const TemporaryFolder folder;
  const auto source = openBytes(folder, BtfWriter(btf, format).dfmf());
  ASSERT_TRUE(source.ok()) << source.issue().text;
  EXPECT_EQ((*source)->lights().kind, DirectionSetKind::kUbo151);
  EXPECT_EQ((*source)->views().kind, DirectionSetKind::kUbo151);
  EXPECT_EQ((*source)->cosineFlag(), CosineFlag::kIncluded);
  expectSame(**source, btf, 1.0f / 1024);
  const auto check = checkReciprocity(**source, 2);
  ASSERT_TRUE(check.ok());
  EXPECT_TRUE(check->decisive() && check->cosineIncluded()) << check->slope;
}

TEST(BtfFile, Bdi_IsReadFullOrSparse_AndRefusedByTheNameOfWhatIsUnknown) {
  const MemoryBtf btf = makeBtf(3, 4, 7);
  BtfFormat format;
  for (const uint8_t compression : {uint8_t{0}, uint8_t{2}})
    for (const uint32_t lines : {4u, 3u, 1u})
      for (const bool filled : {false, true}) {
        format.compression = compression;
        format.lines_per_chunk = lines;
        format.last_chunk_filled = filled;
        expectReads(BtfWriter(btf, format).bdi(), btf, kHalf, "BDI");
      }
  format.missing = {5, 7};
  expectRefused(BtfWriter(btf, format).bdi(), issue_id::kVersion,
                "mask leaves out 2 of 12 texels, the first at (2, 1)");
  format.missing = {};
  format.compression = 1;
  expectRefused(BtfWriter(btf, format).bdi(), issue_id::kVersion, "compressed by bzip");
}

TEST(BtfFile, LightsRewrittenForEachView_MayDifferByRoundingOnly) {
  const MemoryBtf btf = makeBtf(2, 2, 7);
  BtfFormat format;
  format.light_rounding = 3e-7;
  expectReads(BtfWriter(btf, format).dfmf(), btf, kHalf, "rounding");
  format.light_rounding = 1e-2;
  expectRefused(BtfWriter(btf, format).dfmf(), issue_id::kVersion, "view 1 has another light 0 than view 0");
}

TEST(BtfFile, WhatIsNotUnderstood_IsRefusedByName) {
  const MemoryBtf btf = makeBtf(2, 2, 3);
  BtfFormat format;
  format.channels = {"400", "500", "600", "700"};
  expectRefused(BtfWriter(btf, format).fmf(), issue_id::kVersion, "4 channels (400, 500, 600, 700)");
  format.channels = {"Y"};
  expectRefused(BtfWriter(btf, format).dfmf(), issue_id::kVersion, "DFMF of 1 channels");
  format = {};
  format.header_version = 3;
  expectRefused(BtfWriter(btf, format).fmf12(), issue_id::kVersion, "version 3 of the FMF12 header");
}

TEST(BtfFile, OldMetadata_HasNoFlagAndNoNames) {
  const MemoryBtf btf = makeBtf(2, 2, 3);
  for (const uint32_t version : {1u, 2u, 3u}) {
    BtfFormat format;
    format.metadata_version = version;
    format.cosine_flag = 0;
    const TemporaryFolder folder;
    const auto source = openBytes(folder, BtfWriter(btf, format).dfmf());
    ASSERT_TRUE(source.ok()) << source.issue().text;
    EXPECT_EQ((*source)->cosineFlag(), version > 1 ? CosineFlag::kNotIncluded : CosineFlag::kUnknown);
  }
}

TEST(BtfFile, KnownDirections_AreRecognised) {
  const TemporaryFolder folder;
  const MemoryBtf btf = makeBtf(1, 1, 81);
  const auto source = openBytes(folder, BtfWriter(btf).dfmf());
  ASSERT_TRUE(source.ok()) << source.issue().text;
  EXPECT_EQ((*source)->lights().kind, DirectionSetKind::kBonn81);
}

std::vector<std::string> oneOfEachKind(const MemoryBtf& btf) {
  BtfFormat legacy;
  legacy.legacy = true;
  BtfFormat filled;
  filled.last_chunk_filled = true, filled.lines_per_chunk = 3;
  return {BtfWriter(btf).dfmf(),       BtfWriter(btf).fmf(), BtfWriter(btf).fmf12(),
          BtfWriter(btf).pvf(),        BtfWriter(btf).bdi(), BtfWriter(btf, legacy).pvf(),
          BtfWriter(btf, filled).bdi()};
}

TEST(BtfFile, CutAtAnyByte_IsRefused) {
  const TemporaryFolder folder;
  const MemoryBtf btf = makeBtf(2, 2, 3);
  size_t step = 1;  // every byte of one kind; the others have most of their front in common
  for (const std::string& bytes : oneOfEachKind(btf)) {
    for (size_t length = 0; length < bytes.size(); length += step)
      EXPECT_FALSE(openBytes(folder, bytes.substr(0, length)).ok()) << length;
    EXPECT_FALSE(openBytes(folder, bytes + "x").ok());
    step = 13;
  }
}

TEST(BtfFile, AnyChangedByteInFront_IsRefusedOrReadWithoutCrash) {
  const TemporaryFolder folder;
  const MemoryBtf btf = makeBtf(2, 2, 3);
  for (const std::string& bytes : oneOfEachKind(btf))
    for (size_t at = 0; at < bytes.size(); at += at < 32 ? 1 : at < 270 ? 40 : at < 600 ? 1 : 11)
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
  auto source = openBytes(folder, BtfWriter(btf).bdi());
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
  color.model = btf::ColorModel::kLogYuv;
  EXPECT_NEAR(color.rgb({std::log(0.5 + 1e-5), 0, -std::log(0.1 / 1e-5)}).x, 0.5 - 0.1 * 1.13983, 1e-9);
  color.model = btf::ColorModel::kYCoCg;
  EXPECT_NEAR(glm::distance(color.rgb({0.5, 0.1, 0.2}), glm::dvec3(0.4, 0.7, 0.2)), 0, 1e-12);
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

TEST(CroppedSource, IsTheMiddle) {
  const MemoryBtf btf = makeBtf(8, 5, 3);
  const auto cropped = croppedSource(std::make_unique<MemorySource>(btf), 3);
  ASSERT_TRUE(cropped.ok()) << cropped.issue().text;
  EXPECT_EQ((*cropped)->size(), glm::ivec2(3));
  for (int v = 0; v < 3; ++v) {
    const auto values = (*cropped)->view(v);
    ASSERT_TRUE(values.ok());
    ASSERT_EQ(values->size(), 27u);
    for (int l = 0; l < 3; ++l)
      for (size_t t = 0; t < 9; ++t)
        EXPECT_EQ((*values)[size_t(l) * 9 + t], btf.at(v, l, (1 + t / 3) * 8 + 2 + t % 3));
  }
  EXPECT_FALSE(croppedSource(std::make_unique<MemorySource>(btf), 6).ok());
}

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
    EXPECT_EQ(note.find("gamma"), std::string::npos) << note;
  }
}

// Linear values that are decoded as if they were sRGB have about twice the slope.
TEST(Reciprocity, WrongGamma_IsNamed) {
  MemoryBtf btf = reciprocalBtf(true);
  for (glm::vec3& value : btf.values) value = glm::pow(value, glm::vec3(2.2f));
  std::string note;
  ASSERT_TRUE(withCosine(std::make_unique<MemorySource>(btf), CosineFlag::kUnknown, 2, note).ok());
  EXPECT_NE(note.find("gamma"), std::string::npos) << note;
  EXPECT_NE(note.find("sRGB"), std::string::npos) << note;
}

// A signal ends who touches bytes that are gone.
TEST(MappedFile, ThatShrinksWhileItIsReadEndsTheProgramWithItsName) {
  const TemporaryFolder folder;
  const fs::path path = folder / "x.btf";
  std::ofstream(path, std::ios::binary) << std::string(100000, 'x');
  const auto file = MappedFile::open(path);
  ASSERT_TRUE(file.ok());
  fs::resize_file(path, 10);
  const auto readTheEnd = [&] {
    exitWhereMappedFilesShrink();
    volatile std::byte last = (*file)->bytes()[99999];
    std::exit(int(last) * 0);
  };
  EXPECT_EXIT(readTheEnd(), testing::ExitedWithCode(2), "x.btf: became shorter while it was read.*1002");
}

// A writer that replaces a file leaves the old one to those who read it.
TEST(MappedFile, ThatIsReplacedOrRemovedStaysAsItWas) {
  const TemporaryFolder folder;
  const fs::path path = folder / "x.btf";
  std::ofstream(path, std::ios::binary) << std::string(100000, 'x');
  const auto file = MappedFile::open(path);
  ASSERT_TRUE(file.ok());
  std::ofstream(folder / "new.btf", std::ios::binary) << "new";
  fs::rename(folder / "new.btf", path);
  EXPECT_EQ((*file)->bytes()[99999], std::byte{'x'});
  fs::remove(path);
  EXPECT_EQ((*file)->bytes()[99999], std::byte{'x'});
}

}  // namespace
}  // namespace loden::importer
