#include "sample_game/gallery/shapes.h"

#include <cmath>

namespace gallery {
namespace {

constexpr float kPi = 3.14159265f;

struct ProfilePoint {
  float radius, height;  // metres
};

uint16_t addVertex(Shape& shape, glm::vec3 position, glm::vec2 uv) {
  shape.positions.push_back(position);
  shape.uvs.push_back(uv);
  return static_cast<uint16_t>(shape.positions.size() - 1);
}

// Quads of a grid of vertices that was added row by row, `columns` vertices each.
void addGridQuads(Shape& shape, uint16_t first, int columns, int rows) {
  for (int j = 0; j + 1 < rows; ++j)
    for (int i = 0; i + 1 < columns; ++i) {
      const auto a = static_cast<uint16_t>(first + j * columns + i);
      const auto d = static_cast<uint16_t>(a + columns);
      shape.quads.push_back({a, static_cast<uint16_t>(a + 1), static_cast<uint16_t>(d + 1), d});
    }
}

// A ring of vertices around `centre` per row: radius * (sin phi * e1 + cos phi * e2); the first column is
// repeated at the end with its own u, which makes the UV seam.
struct Ring {
  glm::vec3 centre, e1, e2;
  float radius, v;
};
void addTube(Shape& shape, const std::vector<Ring>& rings, int segments, float periods_around) {
  const auto first = static_cast<uint16_t>(shape.positions.size());
  for (const Ring& ring : rings)
    for (int i = 0; i <= segments; ++i) {
      const float phi = 2 * kPi * static_cast<float>(i % segments) / static_cast<float>(segments);
      addVertex(shape, ring.centre + ring.radius * (std::sin(phi) * ring.e1 + std::cos(phi) * ring.e2),
                {periods_around * static_cast<float>(i) / static_cast<float>(segments), ring.v});
    }
  addGridQuads(shape, first, segments + 1, static_cast<int>(rings.size()));
}

// v advances by arc length in periods of the same size as u's at the widest ring.
std::vector<Ring> revolve(const std::vector<ProfilePoint>& profile, float periods_around) {
  float widest = 0;
  for (const ProfilePoint& point : profile) widest = std::fmax(widest, point.radius);
  const float period = 2 * kPi * widest / periods_around;
  std::vector<Ring> rings;
  float length = 0;
  for (size_t i = 0; i < profile.size(); ++i) {
    if (i > 0)
      length +=
          std::hypot(profile[i].radius - profile[i - 1].radius, profile[i].height - profile[i - 1].height);
    rings.push_back({{0, profile[i].height, 0}, {1, 0, 0}, {0, 0, 1}, profile[i].radius, length / period});
  }
  return rings;
}

// A tube along a path in the plane z = 0.
std::vector<Ring> sweep(const std::vector<glm::vec3>& path_and_radius, float periods_around) {
  std::vector<Ring> rings;
  float length = 0;
  const size_t n = path_and_radius.size();
  const float period = 2 * kPi * path_and_radius[0].z / periods_around;
  for (size_t i = 0; i < n; ++i) {
    const glm::vec2 before(path_and_radius[i > 0 ? i - 1 : 0]), here(path_and_radius[i]),
        after(path_and_radius[i + 1 < n ? i + 1 : i]);
    if (i > 0) length += glm::distance(before, here);
    const glm::vec3 direction = glm::normalize(glm::vec3(after - before, 0)), e2(0, 0, 1);
    rings.push_back(
        {glm::vec3(here, 0), glm::cross(direction, e2), e2, path_and_radius[i].z, length / period});
  }
  return rings;
}

// Closes the ring of the last `segments + 1` vertices around the y axis with quads that meet in one point.
void addCap(Shape& shape, int segments, float height) {
  const size_t ring = shape.positions.size() - size_t(segments) - 1;
  const auto flat_uv = [](glm::vec3 p) { return glm::vec2(p.x, -p.z) / kPeriod; };
  std::vector<uint16_t> rim;
  for (int i = 0; i < segments; ++i) {
    const glm::vec3 position = shape.positions[ring + i];
    rim.push_back(addVertex(shape, position, flat_uv(position)));
  }
  const uint16_t centre = addVertex(shape, {0, height, 0}, {0, 0});
  for (int i = 0; i < segments; i += 2)
    shape.quads.push_back({centre, rim[i], rim[i + 1], rim[(i + 2) % segments]});
}

}  // namespace

Shape rectangle(glm::vec3 corner, glm::vec3 along_u, glm::vec3 along_v) {
  Shape shape;
  const glm::vec2 periods(glm::length(along_u) / kPeriod, glm::length(along_v) / kPeriod);
  addVertex(shape, corner, {0, 0});
  addVertex(shape, corner + along_u, {periods.x, 0});
  addVertex(shape, corner + along_v, {0, periods.y});
  addVertex(shape, corner + along_u + along_v, periods);
  addGridQuads(shape, 0, 2, 2);
  return shape;
}

Shape box(glm::vec3 min, glm::vec3 max) {
  const glm::vec3 size = max - min, x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  Shape shape;
  for (const Shape& side :
       {rectangle(min + z, x, y), rectangle(max - y, -z, y), rectangle(max - y - z, -x, y),
        rectangle(min, z, y), rectangle(min + y + z, x, -z), rectangle(min, x, z)}) {
    const auto first = static_cast<uint16_t>(shape.positions.size());
    shape.positions.insert(shape.positions.end(), side.positions.begin(), side.positions.end());
    shape.uvs.insert(shape.uvs.end(), side.uvs.begin(), side.uvs.end());
    addGridQuads(shape, first, 2, 2);
  }
  return shape;
}

Shape drapedCloth(float width, float height, int folds) {
  constexpr int kRows = 9;
  const int columns = folds * 6 + 1;
  Shape shape;
  shape.is_cage = true;
  for (int j = 0; j < kRows; ++j)
    for (int i = 0; i < columns; ++i) {
      const float s = static_cast<float>(i) / static_cast<float>(columns - 1);
      const float t = static_cast<float>(j) / (kRows - 1), drop = 1 - t;
      const float phase = 2 * kPi * static_cast<float>(folds) * s + 0.7f * std::sin(5.1f * s + 1.3f * drop);
      const float depth =
          (0.02f + 0.055f * drop) * std::sin(phase) + 0.03f * drop * std::sin(2.3f * s + 0.4f);
      const float sag = 0.03f * (1 - std::cos(2 * kPi * 2 * s)) * t;
      addVertex(shape, {(s - 0.5f) * width, t * height - sag, depth},
                glm::vec2(s * width, t * height) / kPeriod);
    }
  addGridQuads(shape, 0, columns, kRows);
  return shape;
}

Shape pullover() {
  Shape shape;
  shape.is_cage = true;
  const std::vector<ProfilePoint> profile{{.225f, .86f}, {.232f, .875f},  {.222f, .95f},  {.215f, 1.05f},
                                          {.235f, 1.2f}, {.240f, 1.3f},   {.215f, 1.4f},  {.130f, 1.465f},
                                          {.078f, 1.5f}, {.072f, 1.545f}, {.064f, 1.55f}, {.062f, 1.5f}};
  std::vector<Ring> rings = revolve(profile, 30);
  for (Ring& ring : rings) ring.e2 = {0, 0, 0.62f};  // flatter than it is wide
  addTube(shape, rings, 20, 30);
  for (const float side : {-1.0f, 1.0f}) {
    const std::vector<glm::vec3> sleeve{{side * .13f, 1.40f, .085f},  {side * .21f, 1.36f, .082f},
                                        {side * .262f, 1.25f, .070f}, {side * .290f, 1.12f, .064f},
                                        {side * .305f, 1.0f, .058f},  {side * .315f, .90f, .054f},
                                        {side * .317f, .885f, .050f}, {side * .310f, .915f, .044f}};
    addTube(shape, sweep(sleeve, 9), 10, 9);
  }
  return shape;
}

Shape skirt() {
  constexpr int kRows = 8, kSegments = 72;
  constexpr float kTop = 0.98f, kBottom = 0.3f, kPeriodsAround = 40;
  Shape shape;
  shape.is_cage = true;
  for (int j = 0; j < kRows; ++j)
    for (int i = 0; i <= kSegments; ++i) {
      const float t = static_cast<float>(j) / (kRows - 1), drop = 1 - t;
      const float phi = 2 * kPi * static_cast<float>(i % kSegments) / kSegments;
      const float radius = .165f + .17f * drop + .028f * drop * std::cos(12 * phi + 0.5f * std::sin(2 * phi));
      addVertex(shape,
                {radius * std::sin(phi), kBottom + t * (kTop - kBottom), 0.8f * radius * std::cos(phi)},
                {kPeriodsAround * static_cast<float>(i) / kSegments, t * (kTop - kBottom) / kPeriod});
    }
  addGridQuads(shape, 0, kSegments + 1, kRows);
  return shape;
}

Shape cushion(float side) {
  constexpr int kCells = 8;
  const float half = side / 2, height = 0.32f * side;
  Shape shape;
  shape.is_cage = true;
  // Two sheets, sewn together along the border: thick in the middle, with corners that stick out.
  for (const float face : {1.0f, -1.0f}) {
    const auto first = static_cast<uint16_t>(shape.positions.size());
    for (int j = 0; j <= kCells; ++j)
      for (int i = 0; i <= kCells; ++i) {
        const float s = 2 * static_cast<float>(i) / kCells - 1, t = 2 * static_cast<float>(j) / kCells - 1;
        const float bulge = std::pow((1 - s * s) * (1 - t * t), 0.4f);
        const float pull_s = 1 - 0.07f * (1 - t * t) * std::abs(s),
                    pull_t = 1 - 0.07f * (1 - s * s) * std::abs(t);
        addVertex(shape,
                  {half * s * pull_s, height * (0.5f + 0.5f * face * bulge), -half * t * pull_t * face},
                  glm::vec2(half * s, half * t) / kPeriod);
      }
    addGridQuads(shape, first, kCells + 1, kCells + 1);
  }
  return shape;
}

Shape bottle() {
  Shape shape;
  shape.is_cage = true;
  const std::vector<ProfilePoint> profile{{.135f, 0},    {.150f, .012f}, {.150f, .10f}, {.150f, .20f},
                                          {.150f, .28f}, {.135f, .35f},  {.075f, .41f}, {.050f, .47f},
                                          {.048f, .54f}, {.060f, .565f}, {.060f, .59f}, {.040f, .59f},
                                          {.036f, .54f}, {.036f, .44f}};
  addTube(shape, revolve(profile, 18), 16, 18);
  return shape;
}

Shape teapot() {
  Shape shape;
  shape.is_cage = true;
  const std::vector<ProfilePoint> body{{.11f, 0},      {.14f, .01f},   {.19f, .06f},  {.215f, .13f},
                                       {.20f, .20f},   {.155f, .255f}, {.115f, .28f}, {.11f, .29f},
                                       {.11f, .296f},  {.10f, .30f},   {.07f, .315f}, {.03f, .33f},
                                       {.022f, .345f}, {.034f, .362f}, {.022f, .38f}};
  addTube(shape, revolve(body, 26), 16, 26);
  addCap(shape, 16, .386f);
  const std::vector<glm::vec3> spout{{.15f, .09f, .055f},   {.21f, .11f, .05f},    {.27f, .16f, .036f},
                                     {.31f, .23f, .028f},   {.345f, .285f, .026f}, {.36f, .30f, .027f},
                                     {.352f, .294f, .018f}, {.32f, .24f, .016f}};
  addTube(shape, sweep(spout, 6), 8, 6);
  const std::vector<glm::vec3> handle{{-.17f, .09f, .022f}, {-.24f, .09f, .021f}, {-.30f, .12f, .02f},
                                      {-.325f, .18f, .02f}, {-.30f, .235f, .02f}, {-.23f, .25f, .021f},
                                      {-.14f, .235f, .022f}};
  addTube(shape, sweep(handle, 3), 8, 3);
  return shape;
}

Shape vase() {
  Shape shape;
  shape.is_cage = true;
  const std::vector<ProfilePoint> profile{{.085f, 0},    {.10f, .008f},  {.105f, .04f}, {.15f, .13f},
                                          {.185f, .24f}, {.175f, .35f},  {.12f, .44f},  {.085f, .50f},
                                          {.095f, .55f}, {.135f, .595f}, {.14f, .602f}, {.128f, .60f},
                                          {.085f, .55f}, {.07f, .49f},   {.10f, .40f}};
  addTube(shape, revolve(profile, 22), 16, 22);
  return shape;
}

Shape jar() {
  Shape shape;
  shape.is_cage = true;
  const std::vector<ProfilePoint> profile{{.16f, 0},      {.18f, .01f},   {.205f, .07f}, {.22f, .17f},
                                          {.215f, .27f},  {.18f, .345f},  {.165f, .37f}, {.175f, .40f},
                                          {.178f, .408f}, {.162f, .406f}, {.15f, .37f},  {.165f, .33f},
                                          {.19f, .25f}};
  addTube(shape, revolve(profile, 26), 16, 26);
  return shape;
}

}  // namespace gallery
