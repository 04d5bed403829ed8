// Cameras, frusta, demands and paths.
#include <gtest/gtest.h>

#include <cmath>

#include "runtime/scene/camera.h"
#include "runtime/scene/mesh_analytic.h"

namespace loden::runtime {
namespace {

Camera testCamera() {
  Camera camera;
  camera.position = {0.3, -1.5, 0.9};
  camera.target = {0.1, 0.2, -0.1};
  camera.fov_degrees = 37;
  return camera;
}

TEST(View, PixelsAgreeWithCameraRay) {
  const Camera camera = testCamera();
  const glm::ivec2 size(640, 360);
  const View view = makeView(camera, size);
  for (double px : {0.0, 100.5, 320.0, 640.0})
    for (double py : {0.0, 17.25, 180.0, 360.0}) {
      const glm::dvec3 point = camera.position + 1.7 * cameraRay(camera, px, py, size.x, size.y);
      const glm::vec4 clip = view.clip_from_world * glm::vec4(glm::vec3(point), 1);
      EXPECT_NEAR((clip.x / clip.w + 1) / 2 * size.x, px, 2e-3);
      EXPECT_NEAR((1 - clip.y / clip.w) / 2 * size.y, py, 2e-3);
    }
}

TEST(Frustum, KeepsWhatItSeesAndDropsWhatIsBehind) {
  const Camera camera = testCamera();
  const Frustum frustum = frustumOf(makeView(camera, {640, 360}).clip_from_world);
  const auto boxAround = [](glm::dvec3 p) { return Bounds{glm::vec3(p) - 0.1f, glm::vec3(p) + 0.1f}; };
  EXPECT_TRUE(intersects(frustum, boxAround(camera.target)));
  EXPECT_TRUE(intersects(frustum, boxAround(camera.position)));
  EXPECT_FALSE(intersects(frustum, boxAround(camera.position - 2.0 * (camera.target - camera.position))));
  EXPECT_FALSE(intersects(frustum, boxAround(camera.target + glm::dvec3(10, 0, 0))));
}

// A plane that faces the camera: every pixel's footprint is known.
TEST(DemandLambda, EqualsTheFootprintOfAFacingPlane) {
  Camera camera;
  camera.position = {0, 0, 2};
  camera.up = {0, 1, 0};
  camera.fov_degrees = 40;
  const View view = makeView(camera, {400, 400});
  const Mesh plane = analyticMesh(analyticSurface(SurfaceKind::kPlane));
  const float density = uvDensity(plane, {}, glm::mat4(1));
  EXPECT_NEAR(density, 8, 1e-4);  // 16 tiles on 2 m
  const double pixel = 2 * 2 * std::tan(20 * 3.14159265358979 / 180) / 400;
  const double footprint = std::log2(pixel * 8 * 64);
  const float demand = demandLambda(view, plane.bounds, density, 64);
  EXPECT_LE(demand, footprint);
  EXPECT_GT(demand, footprint - 0.2);  // less by the distance of the corners of the picture only
}

TEST(IsPlain, OnlyFlatMeshesWithUnstretchedUvs) {
  const auto plain = [](SurfaceKind kind, glm::vec2 scale, const glm::mat4& transform) {
    const Mesh mesh = analyticMesh(analyticSurface(kind));
    FlatBtfBinding binding;
    binding.scale = scale;
    return isPlain(mesh, binding, transform, uvDensity(mesh, binding, transform));
  };
  glm::mat4 squeezed(1);
  squeezed[0][0] = 0.5f;
  EXPECT_TRUE(plain(SurfaceKind::kPlane, {5, 5}, glm::mat4(1)));
  EXPECT_FALSE(plain(SurfaceKind::kPlane, {5, 4}, glm::mat4(1)));
  EXPECT_FALSE(plain(SurfaceKind::kPlane, {5, 5}, squeezed));
  EXPECT_FALSE(plain(SurfaceKind::kCylinder, {1, 1}, glm::mat4(1)));
  EXPECT_FALSE(plain(SurfaceKind::kSphere, {1, 1}, glm::mat4(1)));
}

TEST(DemandLambda, IsZeroInsideTheBox) {
  const View view = makeView(testCamera(), {400, 400});
  EXPECT_EQ(demandLambda(view, {glm::vec3(-5), glm::vec3(5)}, 20, 64), 0);
}

TEST(UvDensity, IsTheFinestOfStretchedUvs) {
  const Mesh plane = analyticMesh(analyticSurface(SurfaceKind::kPlane));
  FlatBtfBinding binding;
  binding.scale = {1, 10};  // 8 and 80 periods per metre: the footprint is judged by half its major axis
  EXPECT_NEAR(uvDensity(plane, binding, glm::mat4(1)), 40, 1e-3);
}

TEST(CameraPath, PassesThroughItsKeysAndIsSmooth) {
  const CameraPath path({{1, {0, 0, 0}, {0, 0, 1}}, {2, {1, 0, 0}, {1, 1, 0}}, {5, {1, 3, 0}, {0, 5, 0}}},
                        Camera{});
  EXPECT_EQ(path.duration(), 4);
  EXPECT_LT(glm::distance(path.at(0).position, glm::dvec3(0, 0, 0)), 1e-12);
  EXPECT_LT(glm::distance(path.at(1).position, glm::dvec3(1, 0, 0)), 1e-12);
  EXPECT_LT(glm::distance(path.at(1).target, glm::dvec3(1, 1, 0)), 1e-12);
  EXPECT_LT(glm::distance(path.at(99).position, glm::dvec3(1, 3, 0)), 1e-12);
  const double h = 1e-5;
  const glm::dvec3 before = (path.at(1).position - path.at(1 - h).position) / h;
  const glm::dvec3 after = (path.at(1 + h).position - path.at(1).position) / h;
  EXPECT_LT(glm::distance(before, after), 1e-3);
}

TEST(FacingCone, OfAPlaneIsItsNormal) {
  const Mesh plane = analyticMesh(analyticSurface(SurfaceKind::kPlane));
  const FacingCone cone = facingCone(plane, glm::mat4(1));
  EXPECT_NEAR(cone.axis.z, 1, 1e-6);
  EXPECT_NEAR(cone.angle, 0, 1e-3);
  EXPECT_FALSE(facesAway(cone, plane.bounds, {0, 0, 2}));
  EXPECT_FALSE(facesAway(cone, plane.bounds, {5, 0, 0.1f}));
  EXPECT_TRUE(facesAway(cone, plane.bounds, {0, 0, -5}));
  EXPECT_FALSE(facesAway(cone, plane.bounds, {0, 0, -1})) << "inside the sphere around it: not certain";
  // A mirrored plane still shows its front above: its winding turns with the transform.
  glm::mat4 mirrored(1);
  mirrored[0][0] = -1;
  EXPECT_NEAR(facingCone(plane, mirrored).axis.z, 1, 1e-6);
}

TEST(FacingCone, OfASphereIsEveryDirection) {
  const Mesh sphere = analyticMesh(analyticSurface(SurfaceKind::kSphere));
  const FacingCone cone = facingCone(sphere, glm::mat4(1));
  for (const glm::vec3& eye : {glm::vec3(0, 0, 9), glm::vec3(0, -9, 0), glm::vec3(9, 0, -9)})
    EXPECT_FALSE(facesAway(cone, sphere.bounds, eye));
}

// Against every triangle of a bent strip, from many eyes.
TEST(FacingCone, NeverDropsAFrontFace) {
  Mesh strip = analyticMesh(analyticSurface(SurfaceKind::kCylinder));
  strip.indices.resize(strip.indices.size() / 8);
  const FacingCone cone = facingCone(strip, glm::mat4(1));
  strip.bounds = {glm::vec3(1e9f), glm::vec3(-1e9f)};
  for (const uint32_t index : strip.indices) {
    strip.bounds.min = glm::min(strip.bounds.min, strip.vertices[index].position);
    strip.bounds.max = glm::max(strip.bounds.max, strip.vertices[index].position);
  }
  int dropped = 0;
  for (int k = 0; k < 500; ++k) {
    const glm::vec3 eye =
        8.0f * glm::vec3(std::sin(1.7f * float(k)), std::cos(2.3f * float(k)), std::sin(0.7f * float(k)));
    if (!facesAway(cone, strip.bounds, eye)) continue;
    ++dropped;
    for (size_t i = 0; i < strip.indices.size(); i += 3) {
      const glm::vec3 a = strip.vertices[strip.indices[i]].position,
                      b = strip.vertices[strip.indices[i + 1]].position,
                      c = strip.vertices[strip.indices[i + 2]].position;
      ASSERT_LE(glm::dot(glm::cross(b - a, c - a), eye - a), 1e-6f);
    }
  }
  EXPECT_GT(dropped, 50);
}

}  // namespace
}  // namespace loden::runtime
