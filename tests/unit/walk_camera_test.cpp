// How keys and mouse of loden_walk move its camera, and how it frames and dresses a scene.
#include <gtest/gtest.h>

#include <cmath>

#include "runtime/scene/camera.h"
#include "runtime/scene/mesh_analytic.h"
#include "sample_game/camera_control.h"
#include "sample_game/dress.h"
#include "sample_game/framing.h"

namespace loden::walk {
namespace {

Camera ahead() {
  Camera camera;
  camera.position = {0, 1, 4};
  camera.target = {0, 1, 0};
  camera.up = {0, 1, 0};
  camera.fov_degrees = 40;
  return camera;
}

TEST(WalkCamera, ATapMovesHoweverShort) {
  CameraControl control(ahead(), 2);
  control.press(MoveKey::kAhead);
  control.release(MoveKey::kAhead);  // both between two frames
  EXPECT_TRUE(control.moving());
  EXPECT_TRUE(control.advance(0.001));
  EXPECT_LT(control.camera().position.z, 4);
  const double z = control.camera().position.z;
  control.advance(1);
  EXPECT_EQ(control.camera().position.z, z) << "the key is up";
}

TEST(WalkCamera, MovesByTimeNotByFrame) {
  CameraControl one(ahead(), 2), many(ahead(), 2);
  one.press(MoveKey::kRight);
  many.press(MoveKey::kRight);
  one.advance(2.0);
  for (int i = 0; i < 20; ++i) many.advance(0.1);
  EXPECT_NEAR(one.camera().position.x, many.camera().position.x, 1e-9);
  EXPECT_GT(one.camera().position.x, 0.5);
}

TEST(WalkCamera, ShiftIsFaster) {
  CameraControl slow(ahead(), 2), fast(ahead(), 2);
  for (CameraControl* control : {&slow, &fast}) control->press(MoveKey::kAhead);
  fast.press(MoveKey::kFaster);
  slow.advance(0.5);
  fast.advance(0.5);
  EXPECT_NEAR(4 - fast.camera().position.z, 4 * (4 - slow.camera().position.z), 1e-9);
}

TEST(WalkCamera, LosingTheFocusReleasesAll) {
  CameraControl control(ahead(), 2);
  control.press(MoveKey::kAhead);
  control.beginDrag(DragKind::kOrbit);
  control.releaseAll();
  EXPECT_FALSE(control.moving());
  control.moved({100, 0}, 600);
  EXPECT_FALSE(control.advance(1));
}

TEST(WalkCamera, OrbitKeepsTargetAndDistance) {
  CameraControl control(ahead(), 2);
  control.beginDrag(DragKind::kOrbit);
  for (int i = 0; i < 40; ++i) control.moved({30, 25}, 600);
  const Camera& camera = control.camera();
  EXPECT_NEAR(glm::distance(camera.position, camera.target), 4, 1e-9);
  EXPECT_EQ(camera.target, ahead().target);
  EXPECT_LT(std::abs(glm::normalize(camera.position - camera.target).y), 0.9999) << "never straight above";
  EXPECT_TRUE(control.taken());
}

TEST(WalkCamera, PanMovesWhatIsUnderThePointer) {
  CameraControl control(ahead(), 2);
  control.beginDrag(DragKind::kPan);
  control.moved({0, 300}, 600);  // half the height
  const double height = 2 * 4 * std::tan(20 * 3.14159265358979 / 180);
  EXPECT_NEAR(control.camera().target.y, 1 + height / 2, 1e-6);
}

TEST(WalkCamera, WheelNeverReachesTheTarget) {
  CameraControl control(ahead(), 2);
  for (int i = 0; i < 500; ++i) control.wheel(1);
  EXPECT_GT(glm::distance(control.camera().position, control.camera().target), 1e-4);
  for (int i = 0; i < 500; ++i) control.wheel(-3);
  EXPECT_LT(glm::distance(control.camera().position, control.camera().target), 1e4);
}

TEST(WalkCamera, FocusArrivesAfterAWhile) {
  CameraControl control(ahead(), 2);
  control.focus({1, 0, 0}, 1.5);
  EXPECT_TRUE(control.moving());
  control.advance(0.1);
  EXPECT_NE(control.camera().target, glm::dvec3(1, 0, 0));
  control.advance(5);
  EXPECT_EQ(control.camera().target, glm::dvec3(1, 0, 0));
  EXPECT_NEAR(glm::distance(control.camera().position, control.camera().target), 1.5, 1e-9);
  EXPECT_FALSE(control.moving());
}

TEST(WalkCamera, FramingShowsEveryCornerAndFillsThePicture) {
  const runtime::Bounds box{{-1, 0, -0.2f}, {0.5f, 7, 0.3f}};
  for (const double aspect : {0.5, 1.0, 2.5}) {
    const Camera camera = framed(box, aspect);
    const auto view = runtime::makeView(camera, {int(1000 * aspect), 1000});
    float most = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::vec4 clip = view.clip_from_world * glm::vec4((corner & 1) ? box.max.x : box.min.x,
                                                              (corner & 2) ? box.max.y : box.min.y,
                                                              (corner & 4) ? box.max.z : box.min.z, 1);
      most = std::max({most, std::abs(clip.x / clip.w), std::abs(clip.y / clip.w)});
    }
    EXPECT_LE(most, 1.0f) << aspect;
    EXPECT_GT(most, 0.85f) << aspect;
  }
}

TEST(WalkCamera, PartsOfAViewAreItsPixels) {
  const auto view = runtime::makeView(ahead(), {600, 400});
  const auto part = runtime::partOf(view, {150, 100}, {450, 400}, {100, 100});
  const glm::vec4 point(0.3f, 1.2f, 0, 1);
  const auto pixel = [&](const runtime::View& v) {
    const glm::vec4 clip = v.clip_from_world * point;
    return (glm::vec2(clip) / clip.w * 0.5f + 0.5f) * glm::vec2(v.size);
  };
  const glm::vec2 whole = pixel(view), piece = pixel(part);
  EXPECT_NEAR(piece.x, (whole.x - 150) / 3, 1e-3f);
  EXPECT_NEAR(piece.y, (whole.y - 100) / 3, 1e-3f);
  EXPECT_NEAR(part.pixel_angle, 3 * view.pixel_angle, 1e-6f);
}

runtime::Scene plane() {
  runtime::Scene scene = runtime::analyticScene(SurfaceKind::kPlane, "x.loden", {0, 0, 1});
  scene.materials[0].name = "Cloth";
  return scene;
}

TEST(WalkDress, RaysMeetTheNearestSurface) {
  const runtime::Scene scene = plane();
  const auto hit = firstHit(scene, {0.01, 0.02, 3}, {0, 0, -2});
  ASSERT_TRUE(hit);
  EXPECT_NEAR(hit->z, 0, 1e-9);
  EXPECT_NEAR(hit->x, 0.01, 1e-9);
  EXPECT_FALSE(firstHit(scene, {0.01, 0.02, 3}, {0, 0, 1}));
}

TEST(WalkDress, TilesAreAsLongAsAskedFor) {
  runtime::Scene scene = plane();
  ASSERT_TRUE(dress(scene, 0, 0, 0.02, 2, 0).ok());
  const auto& binding = *scene.materials[0].flat_btf;
  const glm::dvec2 period = periodOfScale(surveyUvs(scene, 0).metresPerUnit(), glm::dvec2(binding.scale), 0);
  EXPECT_NEAR(period.x, 0.02, 1e-6);
  EXPECT_NEAR(period.y, 0.04, 1e-6);
  EXPECT_FALSE(dress(scene, 0, 0, 0.02, 2, 0.4).ok());
}

TEST(WalkDress, NamesTheMaterialsThatThereAre) {
  const runtime::Scene scene = plane();
  EXPECT_EQ(*findMaterial(scene, ""), 0);
  EXPECT_EQ(*findMaterial(scene, "Cloth"), 0);
  const auto unknown = findMaterial(scene, "Sofa");
  ASSERT_FALSE(unknown.ok());
  EXPECT_NE(unknown.issue().text.find("'Cloth'"), std::string::npos) << unknown.issue().text;
}

}  // namespace
}  // namespace loden::walk
