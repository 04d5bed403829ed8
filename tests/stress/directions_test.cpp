// Directions at the edges of what they can be, and on both sides of every seam of every map of directions.

#include <gtest/gtest.h>

#include <random>

#include "material/eval/evaluate.h"
#include "tests/stress/stress.h"
#include "tests/stress/stress_materials.h"

namespace loden::stress {
namespace {

HemisphereLight someSky() {
  HemisphereLight light;
  light.c = {glm::vec3(1, 0.8f, 0.6f), glm::vec3(0.4f), glm::vec3(0.2f),
             glm::vec3(-0.1f),         glm::vec3(0.1f), glm::vec3(0.05f)};
  return light;
}

// How often each rule is broken, of so many values.
struct Broken {
  int64_t values = 0, not_finite_or_negative = 0, lit_from_nowhere = 0;
};

template <class T>
void tryPairs(Evaluator& evaluator, const std::vector<EdgeDirection>& edges, Lookup lookup, Broken& broken) {
  using V3 = glm::vec<3, T>;
  const HemisphereLight sky = someSky();
  LocalSurface<T> curved = LocalSurface<T>::flat(evaluator.material().geometry.aspect);
  curved.curvature = {T(0.3), T(0.05), T(0.05), T(0.2)};
  for (const bool bent : {false, true})
    for (const EdgeDirection& view : edges) {
      const auto surface = bent ? curved : LocalSurface<T>::flat(evaluator.material().geometry.aspect);
      const auto hit =
          evaluator.findHit(glm::vec<2, T>(0.3, 0.7), T(0.25), V3(view.w), lookup, Parallax::kFaded, surface);
      const V3 ambient = evaluator.evaluateEnvironment(hit, sky, V3(view.w));
      broken.values += 1;
      broken.not_finite_or_negative += !blackOrLight(ambient);
      broken.lit_from_nowhere += !bent && !view.valid && ambient != V3(0);
      for (const EdgeDirection& light : edges) {
        const V3 value = evaluator.evaluate(hit, V3(light.w), V3(view.w));
        broken.values += 1;
        broken.not_finite_or_negative += !blackOrLight(value);
        broken.lit_from_nowhere += !bent && (!view.valid || !light.valid) && value != V3(0);
      }
    }
}

TEST(StressDirections, EveryPairOfEdgesIsFiniteAndBlackBelowTheHorizon) {
  Broken broken;
  for (const Material& material : edgeMaterials()) {
    Evaluator evaluator(material);
    evaluator.prepareQuality();
    evaluator.prepareEnvironment();
    std::vector<EdgeDirection> edges = edgeDirections(material.theta_max);
    // All of the named ones; of the seams every so many-th, another each time.
    std::vector<EdgeDirection> some;
    const auto step = static_cast<size_t>(amount(7, 1));
    for (size_t k = 0; k < edges.size(); ++k)
      if (edges[k].name.rfind("seam", 0) != 0 || k % step == 0) some.push_back(edges[k]);
    for (const Lookup lookup :
         {Lookup::kNone, Lookup::kPaper, Lookup::kFast, Lookup::kDefault, Lookup::kQuality}) {
      const Broken before = broken;
      tryPairs<float>(evaluator, some, lookup, broken);
      tryPairs<double>(evaluator, some, lookup, broken);
      EXPECT_EQ(broken.not_finite_or_negative, before.not_finite_or_negative)
          << material.name << ", lookup " << lookupName(lookup);
      EXPECT_EQ(broken.lit_from_nowhere, before.lit_from_nowhere)
          << material.name << ", lookup " << lookupName(lookup);
    }
  }
  record("values of pairs of edge directions", double(broken.values), "all of them tried");
  record("values of pairs of edge directions that are not finite, or negative",
         double(broken.not_finite_or_negative), "0");
  record(
      "values of pairs of edge directions that are not black, though one is no direction or below the "
      "horizon",
      double(broken.lit_from_nowhere), "0");
}

TEST(StressDirections, LengthDoesNotMatterToValues) {
  double worst = 0;
  for (const Material& material : edgeMaterials()) {
    const Evaluator evaluator(material);
    std::mt19937 random(11);
    std::uniform_real_distribution<float> uniform(0, 1);
    for (int k = 0; k < 500; ++k) {
      const auto direction = [&] {
        return glm::vec3(
            directionFromSpherical({1.5 * double(uniform(random)), 6.283 * double(uniform(random))}));
      };
      const glm::vec3 wi = direction(), wo = direction();
      const auto hit = evaluator.findHit(glm::vec2(uniform(random), uniform(random)), 0.25f, wo);
      const glm::vec3 expected = evaluator.evaluate(hit, wi, wo);
      for (const float scale : {1e-6f, 0.25f, 0.9f, 1.1f, 4.0f, 1e6f}) {
        const glm::vec3 off = glm::abs(evaluator.evaluate(hit, scale * wi, scale * wo) - expected);
        worst = std::max(worst, double(std::max({off.x, off.y, off.z})) /
                                    (1 + double(std::max({expected.x, expected.y, expected.z}))));
      }
    }
  }
  // A scale that is no power of two rounds each component by half an ulp. Theta moves by as much over sin
  // theta, at most sqrt(2 * 1.2e-7) at the pole; noise tables change by 1 in a row of 15 degrees.
  const double bound = std::sqrt(2 * 1.2e-7) * 5 / (75 * kPi / 180) * 4;
  record("value at directions 1e-6 to 1e6 times as long, largest change", worst, "<= " + shortNumber(bound));
  EXPECT_LE(worst, bound);
}

// --- seams of the maps ---

// Pairs of unit vectors on either side of all seams, `apart` from each other: columns and rows of a grid, the
// wrap, the diagonals of the concentric map, the pole, the last row, the limit of lookups.
struct SeamPair {
  const char* seam;
  glm::dvec3 a, b;
};
std::vector<SeamPair> seamPairs(double theta_max, int thetas, int phis, double apart) {
  std::vector<SeamPair> pairs;
  const auto across = [&](const char* seam, double theta, double phi, bool along_phi) {
    const double d_phi = along_phi ? apart / 2 / std::max(std::sin(theta), 1e-12) : 0;
    const double d_theta = along_phi ? 0 : apart / 2;
    pairs.push_back({seam, directionFromSpherical({theta - d_theta, phi - d_phi}),
                     directionFromSpherical({theta + d_theta, phi + d_phi})});
  };
  for (const double theta : {0.01, 0.2, 0.7, 1.2, theta_max, 1.4, kThetaMax, 1.55}) {
    for (int column = 0; column < phis; ++column)
      across(column == 0 ? "wrap" : "column", theta, 2 * kPi * column / (phis - 1), true);
    for (int diagonal = 1; diagonal < 8; diagonal += 2) across("diagonal", theta, kPi / 4 * diagonal, true);
  }
  for (const double phi : {0.0, 0.3, 2.2, 4.0}) {
    for (int row = 1; row < thetas; ++row) across("row", theta_max * row / (thetas - 1), phi, false);
    across("limit of lookups", kThetaMax, phi, false);
    pairs.push_back(
        {"pole", directionFromSpherical({apart / 2, phi}), directionFromSpherical({apart / 2, phi + kPi})});
    pairs.push_back({"pole", {0, 0, 1}, directionFromSpherical({apart, phi})});
  }
  return pairs;
}

// Largest difference between neighbours of a table along one axis, per component.
glm::dvec4 steepest(const Texture& table, const DirectionGrid& grid, int quad, bool along_phi) {
  glm::dvec4 most(0);
  for (int co = 0; co < grid.phis; ++co)
    for (int ro = 0; ro < grid.thetas; ++ro)
      for (int ri = 0; ri + (along_phi ? 0 : 1) < grid.thetas; ++ri)
        for (int ci = 0; ci + (along_phi ? 1 : 0) < grid.phis; ++ci) {
          const glm::dvec4 here(fetchTexel(table, 0, ci, ro * grid.thetas + ri, quad * grid.phis + co));
          const glm::dvec4 next(fetchTexel(table, 0, ci + along_phi, ro * grid.thetas + ri + !along_phi,
                                           quad * grid.phis + co));
          most = glm::max(most, glm::abs(next - here));
        }
  return most;
}

// How fast a colour of smoothMaterial can change with the light, per unit of its vector. Between neighbours
// of the table the value is linear in (phi, theta). Theta changes by at most the vector's change, phi by that
// over sin(theta) >= 2 theta / pi; in the first row, where phi may turn by any amount, a column's difference
// shrinks in proportion to theta, so that row_1 stands for theta. On top of that the mean's slope, and the
// fade at the horizon.
double lipschitzBound(const Material& m) {
  const Band& band = m.bands[0];
  const DirectionGrid grid = tableGrid(band, m.theta_max);
  const double row = double(m.theta_max) / (grid.thetas - 1), column = 2 * kPi / (grid.phis - 1);
  double slope[3] = {double(m.mean.kd), 0, 0}, largest[3] = {double(m.mean.ka + m.mean.kd), 0, 0};
  for (int quad = 0; quad < 3; ++quad) {
    const glm::dvec4 by_phi = steepest(band.table, grid, quad, true),
                     by_theta = steepest(band.table, grid, quad, false);
    for (int lane = 0; lane < 4; ++lane) {
      double weight = 0, value = 0;
      for (int t = 0; t < m.side * m.side; ++t)
        weight = std::max(weight,
                          std::abs(double(fetchTexel(band.weights, 0, t % m.side, t / m.side, quad)[lane])));
      for (int z = 0; z < grid.phis; ++z)
        for (int y = 0; y < band.table.height; ++y)
          for (int x = 0; x < grid.phis; ++x)
            value = std::max(value,
                             std::abs(double(fetchTexel(band.table, 0, x, y, quad * grid.phis + z)[lane])));
      weight *= double(band.quad_scale[size_t(quad)][lane]);
      const int channel = quad < 2 ? 0 : lane < 2 ? 1 : 2;
      slope[channel] += weight * (by_phi[lane] / column * (kPi / 2) / row + by_theta[lane] / row);
      largest[channel] += weight * value;
    }
  }
  // Chroma follows the mean's Y; R = Y + 1.402 Cr, B = Y + 1.772 Cb, G lies between.
  const double chroma = std::abs(double(m.mean.cb)) + std::abs(double(m.mean.cr));
  const double all = slope[0] * (1 + 2 * chroma) + 1.772 * (slope[1] + slope[2]);
  const double most = largest[0] * (1 + 2 * chroma) + 1.772 * (largest[1] + largest[2]);
  return all + most / std::cos(double(m.theta_max));
}

TEST(StressDirections, ValuesAreContinuousAcrossEverySeam) {
  const Material material = smoothMaterial();
  Evaluator evaluator(material);
  evaluator.prepareEnvironment();
  const double bound = lipschitzBound(material);
  const DirectionGrid grid = tableGrid(material.bands[0], material.theta_max);
  record("smooth band: derived bound on the change of a colour per unit of the light's vector", bound, "");
  double steepest_found = 0;
  const glm::dvec3 other = glm::normalize(glm::dvec3(0.3, -0.2, 0.8));
  for (const double apart : {1e-3, 1e-6, 1e-9})
    for (const SeamPair& pair : seamPairs(double(material.theta_max), grid.thetas, grid.phis, apart)) {
      const auto hit = evaluator.findHit(glm::dvec2(0.37, 0.81), 0.3, other, Lookup::kNone);
      const glm::dvec3 off =
          glm::abs(evaluator.evaluate(hit, pair.a, other) - evaluator.evaluate(hit, pair.b, other));
      const double distance = glm::length(pair.a - pair.b);
      // 1e-14: rounding of doubles in the value, which is below 1.
      const double change = std::max({off.x, off.y, off.z}) - 1e-14;
      steepest_found = std::max(steepest_found, change / distance);
      EXPECT_LE(change, bound * distance) << pair.seam << ", light, " << apart << " apart";
      // The same table from the other side: smoothEigenValue is about as steep in the view. The view has no
      // fade at the horizon.
      const glm::dvec3 seen =
          glm::abs(evaluator.evaluate(hit, other, pair.a) - evaluator.evaluate(hit, other, pair.b));
      EXPECT_LE(std::max({seen.x, seen.y, seen.z}) - 1e-14, 2 * bound * distance)
          << pair.seam << ", view, " << apart << " apart";
      const glm::dvec3 sky = glm::abs(evaluator.evaluateEnvironment(hit, someSky(), pair.a) -
                                      evaluator.evaluateEnvironment(hit, someSky(), pair.b));
      EXPECT_LE(std::max({sky.x, sky.y, sky.z}) - 1e-14, 4 * bound * distance)
          << pair.seam << ", view, sky, " << apart << " apart";
    }
  record("the steepest change found over all seams, 1e-3, 1e-6 and 1e-9 apart", steepest_found,
         "<= " + shortNumber(bound));
}

// Floats on and beside the seams against doubles of the same bits. A float's theta is off by the rounding of
// z, 1.2e-7 with that of the normalisation, over sin theta: sqrt(2 * 1.2e-7) at the pole at most.
TEST(StressDirections, FloatsAgreeWithDoublesOnEverySeam) {
  const Material material = smoothMaterial();
  const Evaluator evaluator(material);
  const double slope = lipschitzBound(material);
  double most = 0, most_share = 0;
  const glm::vec3 other = glm::normalize(glm::vec3(0.3f, -0.2f, 0.8f));
  const auto hit = evaluator.findHit(glm::vec2(0.37f, 0.81f), 0.3f, other, Lookup::kNone);
  Hit<double> same;
  same.x = same.p = glm::dvec2(hit.x), same.lambda = double(hit.lambda), same.surface = {};
  for (const EdgeDirection& edge : edgeDirections(material.theta_max)) {
    if (!edge.valid || !edge.unit) continue;
    const double sine = std::sqrt(double(edge.w.x) * edge.w.x + double(edge.w.y) * edge.w.y);
    const double bound = slope * std::min(std::sqrt(2.4e-7), 1.2e-7 / std::max(sine, 1e-9)) + 2e-6;
    const glm::dvec3 off = glm::abs(glm::dvec3(evaluator.evaluate(hit, edge.w, other)) -
                                    evaluator.evaluate(same, glm::dvec3(edge.w), glm::dvec3(other)));
    const double worst = std::max({off.x, off.y, off.z});
    most = std::max(most, worst), most_share = std::max(most_share, worst / bound);
    EXPECT_LE(worst, bound) << edge.name << ' ' << edge.w.x << ' ' << edge.w.y << ' ' << edge.w.z;
  }
  record("float against double on the seams, largest difference", most,
         "derived for each, largest share " + shortNumber(most_share));
}

// The maps alone, against the same formulas in double written here.
TEST(StressDirections, MapsOfDirectionsAreContinuousAndInsideTheirSquares) {
  double worst_square = 0, worst_grid = 0, worst_float = 0;
  const double theta_max = 75 * kPi / 180;
  for (const double apart : {1e-3, 1e-6, 1e-9})
    for (const SeamPair& pair : seamPairs(theta_max, 6, 25, apart)) {
      const double distance = glm::length(pair.a - pair.b);
      // The radius is atanh(sin) / atanh(sin 85 degrees), half of which is a side of the square; its slope by
      // sin is at most 1 / cos^2, and sin changes by at most cos(theta) + distance times the vector's change.
      // The concentric map turns arcs of an eighth into straight lines: 4 / pi at most.
      const double limit = std::cos(kThetaMax), reach = std::atanh(std::sin(kThetaMax));
      const double steep = 0.5 / reach / limit * (4 / kPi) * 1.5;
      const glm::dvec2 a = vdimSquareFromView(pair.a), b = vdimSquareFromView(pair.b);
      worst_square = std::max(worst_square, glm::length(a - b) / distance / steep);
      for (const glm::dvec2& s : {a, b})
        EXPECT_TRUE(s.x >= 0 && s.x <= 1 && s.y >= 0 && s.y <= 1) << pair.seam;
      const glm::dvec2 ga = gridPosition(pair.a, theta_max), gb = gridPosition(pair.b, theta_max);
      double turn = std::abs(ga.x - gb.x);
      turn = std::min(turn, 1 - turn);  // the last column repeats the first
      // The azimuth turns by the vector's change over sin(theta); at the pole it has no meaning.
      const double sine = std::min(std::hypot(pair.a.x, pair.a.y), std::hypot(pair.b.x, pair.b.y));
      worst_grid = std::max({worst_grid, turn * sine * 2 * kPi / distance / 2,
                             std::abs(ga.y - gb.y) * theta_max / distance / 1.01});
    }
  for (const EdgeDirection& edge : edgeDirections(float(theta_max))) {
    if (!edge.valid || !edge.unit) continue;
    const glm::vec2 f = vdimSquareFromView(edge.w);
    EXPECT_TRUE(f.x >= 0 && f.x <= 1 && f.y >= 0 && f.y <= 1) << edge.name;
    // Written out again: atanh of the sine, then the concentric map by its quadrants.
    const double sine = std::min(std::hypot(double(edge.w.x), double(edge.w.y)), std::sin(kThetaMax));
    const double r = std::atanh(sine) / std::atanh(std::sin(kThetaMax));
    double phi = std::atan2(double(edge.w.y), double(edge.w.x));
    const double turns = std::floor((phi + kPi / 4) / (kPi / 2)), rest = phi - turns * kPi / 2;
    glm::dvec2 ab(r, r * rest / (kPi / 4));
    for (int k = 0; k < (static_cast<int>(turns) + 4) % 4; ++k) ab = {-ab.y, ab.x};
    const glm::dvec2 expected = sine <= 1e-6 ? glm::dvec2(0.5) : (ab + 1.0) / 2.0;
    // Where sine is below 1e-6 the map says the middle.
    worst_float = std::max(worst_float, glm::length(glm::dvec2(f) - expected));
  }
  record("square of the lookups: largest change, as a share of its derived bound", worst_square, "<= 1");
  record("grid of tables: largest change, as a share of its derived bound", worst_grid, "<= 1");
  record("square of the lookups in float against its formula in double", worst_float, "<= 2e-5");
  EXPECT_LE(worst_square, 1);
  EXPECT_LE(worst_grid, 1);
  // atanh near 85 degrees has a slope of 131 by the sine, whose rounding is 6e-8; half over 3.13.
  EXPECT_LE(worst_float, 2e-5);
}

// On a plane below the reference surface every lookup has one right answer, p = x - slope depth, at every
// seam of the atlas.
TEST(StressDirections, LookupsMeetAPlaneWhereverTheyComeFrom) {
  constexpr double kDepth = 0.2;
  const GeometryImage image = planeImage(32, kDepth), searched = planeImage(32, kDepth, false);
  for (const GeometryImage* surface : {&image, &searched}) {
    const VdimAtlas atlas = buildVdimAtlas(*surface, {20, 12});
    const GeometryTracer tracer(*surface, Interpolation::kCubic);
    const VdimMaps maps{.paper = nullptr, .atlas = &atlas, .tracer = &tracer};
    double worst_float = 0, worst_double = 0;
    int64_t count = 0, lost = 0;
    for (const EdgeDirection& edge : edgeDirections(75 * float(kPi) / 180)) {
      if (!edge.valid || !edge.unit) continue;
      const glm::dvec3 w = glm::dvec3(edge.w);
      const double sine = std::hypot(w.x, w.y), cosine = std::max(w.z, std::cos(kThetaMax));
      const glm::dvec2 slope =
          glm::dvec2(w) * (std::min(1.0, std::sin(kThetaMax) / std::max(sine, 1e-12)) / cosine);
      for (const glm::dvec2 x : {glm::dvec2(0, 0), glm::dvec2(0.5, 0.25), glm::dvec2(0.3017, 0.8913)}) {
        const glm::dvec2 expected = x - slope * kDepth;
        for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault, Lookup::kQuality}) {
          const auto f = vdimLookup(maps, lookup, glm::vec2(x), edge.w);
          const auto d = vdimLookup(maps, lookup, x, w);
          const auto off = [&](const glm::dvec2& p) {
            const glm::dvec2 away = p - expected;  // whole periods mean nothing
            return glm::length(away - glm::floor(away + 0.5));
          };
          ++count, lost += !f.converged || !d.converged;
          worst_float = std::max(worst_float, off(glm::dvec2(f.p)));
          worst_double = std::max(worst_double, off(d.p));
        }
      }
    }
    const std::string kind =
        surface->identity_parameterization ? "a height field" : "a parameterized surface";
    const std::string what = "lookups on a plane that is " + kind + ": ";
    record(what + "searches that do not converge, of " + std::to_string(count), double(lost), "0");
    record(what + "difference of p to its closed form, tile periods", worst_double, "<= 1e-5");
    record(what + "difference of p to its closed form with x and wo in float, tile periods", worst_float,
           "<= 5e-5");
    EXPECT_EQ(lost, 0);
    // The plane's z is a code of 16 bits of its own range and x codes of 10 bits of a range near 0.
    EXPECT_LE(worst_double, 1e-5);
    // slope <= 11.4 times the depth .2, with relative roundings of 6e-8 of slope and of cosine / .087.
    EXPECT_LE(worst_float, 5e-5);
  }
}

}  // namespace
}  // namespace loden::stress
