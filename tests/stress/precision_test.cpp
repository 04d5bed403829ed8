// The ladder of precisions: double, float, tables and weights in half floats, 16 and 8 bits, each against the
// definition in double.

#include <gtest/gtest.h>

#include <random>

#include "material/eval/evaluate.h"
#include "material/eval/near_term.h"
#include "tests/stress/stress.h"
#include "tests/stress/stress_materials.h"

namespace loden::stress {
namespace {

// The largest error that rounding to codes allows: of each product the half step of either factor times the
// largest of the other; 1.772 of chroma at most.
double boundOf(const Material& m, double relative, double absolute) {
  const Band& band = m.bands[0];
  double sum = 0;
  for (int q = 0; q < band.quads(); ++q)
    for (int lane = 0; lane < 4; ++lane) {
      double weight = 0, table = 0;
      for (int mip = 0; mip < band.weights.mips; ++mip)
        for (int t = 0; t < band.weights.mipWidth(mip) * band.weights.mipHeight(mip); ++t)
          weight =
              std::max(weight, std::abs(double(fetchTexel(band.weights, mip, t % band.weights.mipWidth(mip),
                                                          t / band.weights.mipWidth(mip), q)[lane])));
      for (int z = 0; z < band.table.width; ++z)
        for (int y = 0; y < band.table.height; ++y)
          for (int x = 0; x < band.table.width; ++x)
            table = std::max(
                table, std::abs(double(fetchTexel(band.table, 0, x, y, q * band.table.width + z)[lane])));
      sum += std::abs(double(band.quad_scale[size_t(q)][lane])) * weight * table *
             (q < band.y_quads ? 1 : 1.772);
    }
  // Both factors in steps of their largest magnitude.
  return sum * 2 * (relative + absolute);
}

struct Sample {
  glm::dvec2 x;
  double lambda;
  glm::dvec3 wi, wo;
};
std::vector<Sample> samples() {
  std::mt19937 random(71);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<Sample> all(size_t(amount(20'000, 300'000)));
  for (Sample& s : all) {
    // Floats, so that every precision is asked the same.
    const auto direction = [&] {
      return glm::dvec3(glm::vec3(
          directionFromSpherical({1.55 * double(uniform(random)), 6.28 * double(uniform(random))})));
    };
    s = {glm::dvec2(uniform(random), uniform(random)), double(4 * uniform(random)), direction(), direction()};
  }
  return all;
}

TEST(StressPrecision, BandsInEveryPrecisionAgainstTheDefinition) {
  const Material exact = smoothMaterial(16);
  const std::vector<Sample> all = samples();
  struct Rung {
    const char* name;
    Material material;
    bool floats;
    double bound;  // of the value; white is 1
  };
  // Half floats round by 2^-11 of a value, codes by half a step of the largest. Evaluated in floats there are
  // the roundings of theta besides: 1.2e-7 over sin(theta), at slopes of the table up to 3.
  const double floats = 3 * std::sqrt(2.4e-7);
  const std::vector<Rung> rungs{
      {"double, tables in floats", exact, false, boundOf(exact, 6e-8, 0)},
      {"float, tables in floats", exact, true, boundOf(exact, 6e-8, 0) + floats},
      {"float, tables and weights in halves", stored(exact, TexelFormat::kRGBA16Sfloat), true,
       boundOf(exact, std::exp2(-12), 0) * 2 + floats},
      {"float, 16 bits", stored(exact, TexelFormat::kRGBA16Snorm), true,
       boundOf(exact, 0, 0.5 / 32767) + floats},
      {"float, 8 bits", stored(exact, TexelFormat::kRGBA8Snorm), true, boundOf(exact, 0, 0.5 / 127) + floats},
  };
  for (const Rung& rung : rungs) {
    const Evaluator evaluator(rung.material);
    Histogram ulps, codes;
    double worst = 0;
    for (const Sample& s : all) {
      const glm::dvec3 expected = smoothValue(16, s.x, s.lambda, s.wi, s.wo);
      glm::dvec3 got;
      if (rung.floats)
        got = glm::dvec3(evaluator.evaluate(
            evaluator.findHit(glm::vec2(s.x), float(s.lambda), glm::vec3(s.wo), Lookup::kNone),
            glm::vec3(s.wi), glm::vec3(s.wo)));
      else
        got = evaluator.evaluate(evaluator.findHit(s.x, s.lambda, s.wo, Lookup::kNone), s.wi, s.wo);
      const double off = std::abs(got.y - expected.y);
      worst = std::max(worst, largestOf(got - expected));
      ulps.add(off / ulpOf(expected.y));
      codes.add(off * 255);
    }
    record(std::string(rung.name) + ": largest error, white is 1", worst,
           "<= " + shortNumber(rung.bound) + ", derived");
    recordText(std::string(rung.name) + ": green, error in ulp of a float", ulps.text(), "");
    recordText(std::string(rung.name) + ": green, error in 1/255", codes.text(), "");
    EXPECT_LE(worst, rung.bound) << rung.name;
    EXPECT_EQ(codes.shareUpTo(0.5), 1) << rung.name << " shows on a screen of 8 bits";
  }
}

// Every half and back: 2^-11 of a value from 6.1e-5 to 65504, 2^-25 below.
TEST(StressPrecision, HalvesRoundToTheNearest) {
  int64_t wrong = 0, count = 0;
  // All halves survive, and between two of them the nearer one is taken, the even one from the middle.
  for (uint32_t bits = 0; bits < 0x7c00; ++bits) {
    const float low = floatFromHalf(uint16_t(bits));
    // By definition: sign, five bits of exponent, ten of mantissa.
    const int exponent = int(bits >> 10), mantissa = int(bits & 0x3ff);
    const double defined =
        exponent == 0 ? mantissa * std::exp2(-24) : (1 + mantissa / 1024.0) * std::exp2(exponent - 15);
    wrong += double(low) != defined;
    wrong += halfFromFloat(low) != bits || halfFromFloat(-low) != (bits | 0x8000);
    ++count;
    if (bits + 1 == 0x7c00) continue;
    const float high = floatFromHalf(uint16_t(bits + 1)), middle = low + (high - low) / 2;
    wrong += halfFromFloat(middle) != (bits % 2 == 0 ? bits : bits + 1);
    wrong += halfFromFloat(below(middle)) != bits || halfFromFloat(above(middle)) != bits + 1;
  }
  record("halves from 0 to 65504, and the floats between them", double(count), "all tried");
  record("halves from 0 to 65504, and the floats between them, that are not rounded to the nearest",
         double(wrong), "0");
  EXPECT_EQ(wrong, 0);
  // Texels saturate instead of becoming infinite.
  Texture texel = Texture::make(TexelFormat::kRGBA16Sfloat, TextureShape::kArray2D, 1, 1, 1);
  storeTexel(texel, 0, 0, 0, 0, {1e6f, -1e30f, INFINITY, 65520.0f});
  const glm::vec4 back = fetchTexel(texel, 0, 0, 0, 0);
  EXPECT_EQ(back, glm::vec4(65504, -65504, 65504, 65504));
}

// Codes of 8 and 16 bits: half a step at most, ends and zero exactly.
TEST(StressPrecision, CodesRoundToTheNearest) {
  struct Format {
    TexelFormat format;
    double low, steps;
  };
  for (const Format& f : {Format{TexelFormat::kRGBA8Unorm, 0, 255},
                          {TexelFormat::kRGBA8Snorm, -1, 127},
                          {TexelFormat::kRGBA16Unorm, 0, 65535},
                          {TexelFormat::kRGBA16Snorm, -1, 32767}}) {
    Texture texel = Texture::make(f.format, TextureShape::kArray2D, 1, 1, 1);
    double worst = 0;
    for (int k = 0; k <= 200'000; ++k) {
      const float value = float(f.low + (1 - f.low) * k / 200'000);
      storeTexel(texel, 0, 0, 0, 0, glm::vec4(value));
      worst = std::max(worst, std::abs(double(fetchTexel(texel, 0, 0, 0, 0).z) - double(value)) * f.steps);
    }
    record(std::string("codes of ") + texelFormatName(f.format) + ": largest error, in steps", worst,
           "<= .5005");
    EXPECT_LE(worst, 0.5005);  // the decoded value is a float
    for (const float exact : {float(f.low), 0.0f, 1.0f}) {
      storeTexel(texel, 0, 0, 0, 0, glm::vec4(exact));
      EXPECT_EQ(fetchTexel(texel, 0, 0, 0, 0).x, exact);
    }
    storeTexel(texel, 0, 0, 0, 0, {NAN, INFINITY, -INFINITY, 2});
    EXPECT_EQ(fetchTexel(texel, 0, 0, 0, 0), glm::vec4(0, 1, float(f.low), 1));
  }
}

// The lookup against traced rays, where the surface has no silhouette to fall off: in texels of the geometry
// image. In float the lookup runs on the GPU alone (edges_gl_test.cpp).
TEST(StressPrecision, LookupsFindTheTracedPoint) {
  const GeometryImage image = bumpImage(64, 0.02);
  const VdimAtlas atlas = buildVdimAtlas(image, {});
  const GeometryTracer exact(image, Interpolation::kBilinear);
  const VdimMaps maps{.paper = nullptr, .atlas = &atlas, .tracer = nullptr};
  for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault}) {
    double to_traced = 0;
    std::mt19937 random(9);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int64_t k = 0; k < amount(20'000, 500'000); ++k) {
      const glm::vec3 wo(
          directionFromSpherical({1.0 * double(uniform(random)), 6.28 * double(uniform(random))}));
      const glm::vec2 x(uniform(random), uniform(random));
      const auto found = vdimLookup(maps, lookup, glm::dvec2(x), glm::dvec3(wo));
      // Traced on triangles, of which two stand for a bilinear patch.
      const auto hit = exact.traceView(glm::dvec2(x), glm::dvec3(wo));
      ASSERT_TRUE(hit);
      to_traced = std::max(to_traced, glm::length(hit->p - found.p) * 64);
    }
    const std::string name(lookupName(lookup));
    record("lookup " + name + " against traced: largest difference, texels", to_traced, "<= .05");
    EXPECT_LE(to_traced, 0.05);
  }
}

}  // namespace
}  // namespace loden::stress
