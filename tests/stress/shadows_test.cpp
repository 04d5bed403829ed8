// V by look-up on planes, cylinders and spheres against rays through an analytic relief in space: no acne,
// and no leak beyond a stated bias.

#include <gtest/gtest.h>

#include <random>

#include "material/eval/near_term.h"
#include "material/model/vdim.h"
#include "tests/stress/stress.h"
#include "tests/stress/stress_materials.h"

namespace loden::stress {
namespace {

// What bodies the reference surface: its radius in tile lengths along x and along y; 0: flat.
struct Body {
  const char* name;
  double radius_x, radius_y;
};
// Of material/model/analytic_surface.h: 24 tiles around.
const double kRadius = 24 / (2 * kPi);
const Body kBodies[] = {{"plane", 0, 0}, {"cylinder", kRadius, 0}, {"sphere", kRadius, kRadius}};

LocalSurface<double> surfaceOf(const Body& body) {
  LocalSurface<double> s;
  s.curvature = glm::dmat2(0);
  if (body.radius_x > 0) s.curvature[0][0] = 1 / body.radius_x;
  if (body.radius_y > 0) s.curvature[1][1] = 1 / body.radius_y;
  return s;
}

// A point at (u, v, z): u and v along the surface from the origin, z above it; and its frame. On the sphere u
// and v are those of the exponential map, which like the look-up keeps lengths around the origin.
glm::dvec3 inSpace(const Body& body, const glm::dvec3& uvz) {
  if (body.radius_x == 0) return uvz;
  const double r = body.radius_x + uvz.z;
  if (body.radius_y == 0)
    return {r * std::sin(uvz.x / body.radius_x), uvz.y, r * std::cos(uvz.x / body.radius_x)};
  const double s = std::hypot(uvz.x, uvz.y), angle = s / body.radius_x;
  const glm::dvec2 along = s > 0 ? glm::dvec2(uvz) / s : glm::dvec2(0);
  return {r * std::sin(angle) * along.x, r * std::sin(angle) * along.y, r * std::cos(angle)};
}
glm::dvec3 onSurface(const Body& body, const glm::dvec3& p) {
  if (body.radius_x == 0) return p;
  if (body.radius_y == 0)
    return {body.radius_x * std::atan2(p.x, p.z), p.y, std::hypot(p.x, p.z) - body.radius_x};
  const double across = std::hypot(p.x, p.y), angle = std::atan2(across, p.z);
  const glm::dvec2 along = across > 0 ? glm::dvec2(p) / across : glm::dvec2(0);
  return {body.radius_x * angle * along.x, body.radius_x * angle * along.y, glm::length(p) - body.radius_x};
}

// How far the relief stands over a light ray that starts at P, at most, beyond `near` tile lengths of P:
// above 0 it blocks, and by so much; below 0 the ray stays clear by so much.
double excessOf(const Body& body, const std::function<double(glm::dvec2)>& height, const glm::dvec3& start,
                const glm::dvec3& wi, double near) {
  double most = -1e9;
  constexpr double kStep = 2e-3;
  for (double t = near; t < 6; t += kStep) {
    const glm::dvec3 at = onSurface(body, start + t * wi);
    if (at.z > 1e-3) break;
    most = std::max(most, height(glm::dvec2(at)) - at.z);
  }
  return most;
}

struct Shadows {
  int64_t tried = 0, dark = 0, acne = 0, leaks = 0, undecided = 0;
  double largest_leak = 0, largest_acne = 0;
};

// Points on the relief around the origin of the body, which every x is in turn.
Shadows tryBody(const Body& body, Lookup lookup, double depth, double bias, int64_t count) {
  const GeometryImage image = bumpImage(64, depth);
  const VdimAtlas atlas = buildVdimAtlas(image, {});
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  Shadows s;
  while (s.tried < count) {
    const glm::dvec2 p(unit(random), unit(random));
    const auto height = [&](glm::dvec2 uv) { return bumpHeight(p + uv, depth); };
    // The surface's frame at P is that of the body there, as P lies under the origin.
    const double z = unit(random) * 0.9 + 0.08, phi = 2 * kPi * unit(random), sine = std::sqrt(1 - z * z);
    const glm::dvec3 wi(sine * std::cos(phi), sine * std::sin(phi), z);
    // Lights that the slope at P faces; the others are black by N.L already.
    constexpr double kD = 1e-5;
    const glm::dvec3 normal = glm::normalize(glm::dvec3(-(height({kD, 0}) - height({-kD, 0})) / (2 * kD),
                                                        -(height({0, kD}) - height({0, -kD})) / (2 * kD), 1));
    if (glm::dot(normal, wi) < 0.05) continue;
    ++s.tried;
    const double h = bumpHeight(p, depth);
    const glm::dvec3 start = inSpace(body, {0, 0, h});
    const double excess = excessOf(body, height, start, wi, 3.0 / 64);
    const bool lit =
        lookedUpVisibility(atlas, lookup, surfaceOf(body), glm::dvec3(p, h), p, normal, wi, 0.0) > 0.5;
    s.dark += !lit;
    if (lit && excess > 0) s.largest_leak = std::max(s.largest_leak, excess);
    if (!lit && excess < 0) s.largest_acne = std::max(s.largest_acne, -excess);
    s.leaks += lit && excess > bias;
    s.acne += !lit && excess < -bias;
    s.undecided += std::abs(excess) <= bias;
  }
  return s;
}

TEST(StressShadows, FlatTilesOnConvexBodiesHaveNone) {
  int64_t tried = 0, dark = 0;
  for (const Body& body : kBodies)
    for (const double depth : {0.0, 1e-3, 0.2}) {
      const GeometryImage image = planeImage(64, depth);
      const VdimAtlas atlas = buildVdimAtlas(image, {});
      std::mt19937 random(2);
      std::uniform_real_distribution<double> unit(0, 1);
      for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault})
        for (int64_t k = 0; k < amount(5'000, 200'000); ++k) {
          const glm::dvec2 p(unit(random), unit(random));
          // Half of the lights below 6 degrees.
          const double z = k % 2 == 0 ? std::pow(10.0, -1 - 4 * unit(random)) : unit(random);
          const double phi = 2 * kPi * unit(random), sine = std::sqrt(1 - z * z);
          const glm::dvec3 wi(sine * std::cos(phi), sine * std::sin(phi), z);
          tried += 2;
          const glm::dvec3 up(0, 0, 1);
          const double wide = unit(random);
          dark += lookedUpVisibility(atlas, lookup, surfaceOf(body), glm::dvec3(p, -depth), p, up, wi, wide) <
                  0.999;
          LocalSurface<float> f;
          f.curvature = glm::mat2(surfaceOf(body).curvature);
          dark += lookedUpVisibility(atlas, lookup, f, glm::vec3(p, -depth), glm::vec2(p), glm::vec3(up),
                                     glm::vec3(wi), float(wide)) < 0.999f;
        }
    }
  const std::string what = "flat tiles on plane, cylinder and sphere, lights down to the horizon: ";
  record(what + "points, with coordinates in double and in float", double(tried), "tried");
  record(what + "points in a shadow of their own (acne)", double(dark), "0");
  EXPECT_EQ(dark, 0);
}

TEST(StressShadows, ReliefsLeakNoLightBeyondTheBias) {
  constexpr double kDepth = 0.12, kBias = 8e-3;
  for (const Body& body : kBodies)
    for (const Lookup lookup : {Lookup::kFast, Lookup::kDefault}) {
      const Shadows s = tryBody(body, lookup, kDepth, kBias, amount(4'000, 200'000));
      const std::string what = std::string(body.name) + ", lookup " + std::string(lookupName(lookup));
      const auto share = [&](int64_t n) { return double(n) / double(s.tried); };
      record(what + ": share of points in shadow", share(s.dark), "");
      const std::string bias = shortNumber(kBias) + " tile lengths";
      record(what + ": share of points lit though blocked by more than " + bias + " (leaks)", share(s.leaks),
             "<= .001");
      record(what + ": share of points dark though clear by more than " + bias + " (acne)", share(s.acne),
             "<= .001");
      record(what + ": the largest height of a blocker over a lit point", s.largest_leak, "");
      record(what + ": the largest clearance of a dark point", s.largest_acne, "");
      EXPECT_LE(share(s.leaks), 0.001) << what;
      EXPECT_LE(share(s.acne), 0.001) << what;
      EXPECT_GT(share(s.dark), 0.02) << what;
    }
}

}  // namespace
}  // namespace loden::stress
