// What a bake puts where a view sees nothing, and texels that are fitted to how they are read.
#include "importer/bake/bake_scene.h"
#include "importer/bake/linear_texels.h"
#include "importer/bake/push_pull.h"
#include "importer/base/random.h"
#include "tests/unit/small_bakes.h"

namespace loden::importer {
namespace {

using namespace testing;  // NOLINT: small tiles and bakes

TEST(Bake, HarmonicFillChangesOnlyWhatAViewDoesNotSee) {
  const TemporaryFolder a, b;
  BakeOptions options = smallBake(16);
  const BakedOutput plain = baked(groovedTile(), a.path(), options);
  options.fill = FillMethod::kHarmonic;
  const BakedOutput harmonic = baked(groovedTile(), b.path(), options);
  EXPECT_EQ(plain.manifest().fill, FillMethod::kPushPull);
  EXPECT_EQ(harmonic.manifest().fill, FillMethod::kHarmonic);
  size_t filled = 0, changed = 0;
  for (int view = 0; view < plain.manifest().directions.size(); ++view) {
    const auto visible = *plain.visibleView(view);
    EXPECT_EQ(visible, *harmonic.visibleView(view));  // the mask of what is defined stays beside the maps
    const auto p = *plain.flatView(view), h = *harmonic.flatView(view);
    for (size_t k = 0; k < p.size(); ++k) {
      const bool defined = visible[k % visible.size()] > 0;
      EXPECT_TRUE(!defined || p[k] == h[k]);
      filled += !defined, changed += p[k] != h[k];
    }
  }
  EXPECT_GT(filled, 100u);
  EXPECT_GT(changed, filled / 4);
}

// The view nearest to `view` that sees a texel; -1 if none does.
int nearestView(const BakedOutput& output, int view, size_t texel) {
  const auto& directions = output.manifest().directions.samples;
  int nearest = -1;
  for (int other = 0; other < int(directions.size()); ++other)
    if ((*output.visibleView(other))[texel] > 0 &&
        (nearest < 0 || glm::dot(directions[other], directions[view]) >
                            glm::dot(directions[nearest], directions[view]) + 1e-12))
      nearest = other;
  return nearest;
}

TEST(Bake, NearestViewFillCopiesHiddenTexelsFromTheNearestViewThatSeesThem) {
  const TemporaryFolder a, b;
  BakeOptions options = smallBake();
  const BakedOutput plain = baked(groovedTile(), a.path(), options);
  options.fill = FillMethod::kNearestView;
  const BakedOutput filled = baked(groovedTile(), b.path(), options);
  EXPECT_EQ(filled.manifest().fill, FillMethod::kNearestView);
  size_t hidden = 0;
  for (int view = 0; view < plain.manifest().directions.size(); ++view) {
    const auto visible = *plain.visibleView(view);
    const auto p = *plain.flatView(view), f = *filled.flatView(view);
    for (size_t t = 0; t < visible.size(); ++t) {
      const int source = nearestView(plain, view, t);
      const auto expected = source < 0 || visible[t] > 0 ? p : *plain.flatView(source);
      hidden += visible[t] == 0;
      for (size_t k = t; k < p.size(); k += visible.size()) ASSERT_EQ(f[k], expected[k]) << view << ' ' << t;
    }
  }
  EXPECT_GT(hidden, 20u);
}

TEST(Bake, NearestViewFillGivesTheSameBytesInShardsAndAgain) {
  const TemporaryFolder whole, shared;
  BakeOptions options = smallBake();
  options.fill = FillMethod::kNearestView;
  (void)baked(groovedTile(), whole.path(), options);
  options.shards = 2;
  for (const int shard : {1, 0, 0}) {  // the last run fills a second time what is filled
    options.shard = shard, options.resume = true;
    ASSERT_TRUE(bake(groovedTile(), "test", shared.path(), options).ok());
  }
  EXPECT_EQ(contents(whole.path()), contents(shared.path()));
}

TEST(Bake, LinearTexelsChangeOnlyTheFlatMaps) {
  const TemporaryFolder a, b, c;
  BakeOptions options = smallBake();
  (void)baked(groovedTile(), a.path(), options);
  options.texels = TexelMethod::kLinear;
  options.threads = 1;
  EXPECT_EQ(baked(groovedTile(), b.path(), options).manifest().texels, TexelMethod::kLinear);
  options.threads = 3;
  (void)baked(groovedTile(), c.path(), options);
  EXPECT_EQ(contents(b.path()), contents(c.path()));
  const auto mean = contents(a.path()), linear = contents(b.path());
  for (const auto& [name, bytes] : mean)
    EXPECT_EQ(bytes != linear.at(name), name.starts_with("flat/") || name == "bake.json") << name;
}

// Where black and white samples disagree, the fit stays closer to the black ones than their mean does.
TEST(LinearTexels, ErrOnTheBrightSide) {
  constexpr int n = 6, per_side = 2;
  LinearTexels linear(n, per_side, 1);
  for (int t = 0; t < n * n; ++t)
    for (int k = 0; k < per_side * per_side; ++k)
      for (const glm::vec3& value : {glm::vec3(0), glm::vec3(1)})
        linear.add({t % n, t / n}, samplePosition(k, per_side), std::span(&value, 1));
  std::vector<glm::vec3> texels(n * n, glm::vec3(0.5f));
  linear.fit(0, texels);
  for (const glm::vec3& texel : texels) {
    EXPECT_LT(texel.y, 0.3f);
    EXPECT_GT(texel.y, 0.1f) << "bright samples count too";
  }
}

// A map that its own filter has read: the fit gives it back, and does not touch what has no samples around
// it.
TEST(LinearTexels, RecoverAMapFromItsFilteredSamples) {
  constexpr int n = 12, per_side = 4;
  std::vector<glm::vec3> map;
  for (int t = 0; t < n * n; ++t) map.emplace_back(uniform(31, t), uniform(32, t), 0.5f);
  LinearTexels linear(n, per_side, 1);
  std::vector<glm::vec3> texels(n * n, glm::vec3(0.5f));
  const auto seen = [](int i, int j) { return i < 8 && j < 8; };
  double mean_error = 0, fitted_error = 0;
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      if (!seen(i, j)) continue;
      glm::vec3& mean = texels[size_t(j * n + i)] = glm::vec3(0);
      for (int k = 0; k < per_side * per_side; ++k) {
        const glm::dvec2 at = glm::dvec2(i, j) + samplePosition(k, per_side) - 0.5, cell = glm::floor(at),
                         f = at - cell;
        const auto read = [&](int x, int y) {
          return map[size_t((int(cell.y) + y + n) % n * n + (int(cell.x) + x + n) % n)];
        };
        const glm::vec3 value = glm::mix(glm::mix(read(0, 0), read(1, 0), float(f.x)),
                                         glm::mix(read(0, 1), read(1, 1), float(f.x)), float(f.y));
        linear.add({i, j}, samplePosition(k, per_side), std::span(&value, 1));
        mean += value / float(per_side * per_side);
      }
    }
  const auto means = texels;
  linear.fit(0, texels);
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      const size_t t = size_t(j * n + i);
      if (i > 8 && j > 8 && i < n - 1 && j < n - 1) {
        EXPECT_EQ(texels[t], means[t]);
      }
      if (i < 1 || j < 1 || i > 6 || j > 6) continue;  // the border hangs on the first guess
      mean_error = std::max(mean_error, double(glm::distance(means[t], map[t])));
      fitted_error = std::max(fitted_error, double(glm::distance(texels[t], map[t])));
    }
  EXPECT_GT(mean_error, 0.3);
  EXPECT_LT(fitted_error, 0.1);  // 12 steps and the weight of the first guess
}

TEST(PushPull, KeepsWhatIsDefinedAndFillsTheRestFromAround) {
  for (const int side : {1, 2, 7, 16, 33}) {
    const size_t texels = size_t(side * side);
    std::vector<float> weight(texels);
    std::vector<glm::vec3> values(texels, glm::vec3(-99));
    for (size_t t = 0; t < texels; t += 5) weight[t] = 0.25f, values[t] = glm::vec3(float(t % 3), 2, 1);
    const auto before = values;
    PushPull(side, weight).apply(values);
    for (size_t t = 0; t < texels; ++t) {
      EXPECT_TRUE(weight[t] == 0 || values[t] == before[t]);
      EXPECT_GE(values[t].x, 0);
      EXPECT_LE(values[t].x, 2);
      EXPECT_NEAR(values[t].y, 2, 1e-5);
    }
  }
}

TEST(PushPull, LeavesAnEmptyImageAlone) {
  std::vector<glm::vec3> values(9, glm::vec3(3));
  PushPull(3, std::vector<float>(9, 0)).apply(values);
  EXPECT_EQ(values, std::vector<glm::vec3>(9, glm::vec3(3)));
}

}  // namespace
}  // namespace loden::importer
