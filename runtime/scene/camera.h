// From a camera to what is drawn with it: transforms, frustum, pixel footprints, and paths to move it along.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "material/model/analytic_surface.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// A camera and the picture it makes. Pixels agree with cameraRay() of material/model/analytic_surface.h.
struct View {
  glm::mat4 clip_from_world{1};
  glm::vec3 position{0};       // world, metres
  glm::ivec2 size{1, 1};       // pixels
  float pixel_angle = 0.001f;  // metres across one pixel at 1 m distance from the camera's plane
  float edge_cosine = 1;       // of the angle between the axis and the picture's corners
};
struct DepthRange {
  double near_plane = 0.02, far_plane = 200;  // metres
};
View makeView(const Camera& camera, glm::ivec2 size, DepthRange depth = {});

// What the view shows of a rectangle of its picture, [from, to) in pixels from the bottom left, as a picture
// of that many pixels, or of `size` instead.
View partOf(const View& view, glm::ivec2 from, glm::ivec2 to);
View partOf(const View& view, glm::ivec2 from, glm::ivec2 to, glm::ivec2 size);

// A camera of a glTF scene, as the same kind of camera.
Camera cameraFromScene(const SceneCamera& camera);

// Six planes (normal inwards, xyz . p + w >= 0 inside).
using Frustum = std::array<glm::vec4, 6>;
Frustum frustumOf(const glm::mat4& clip_from_world);
// False only if the box is certainly outside.
bool intersects(const Frustum& frustum, const Bounds& world);

// The directions that a mesh's front faces look in: all within the angle of the axis.
struct FacingCone {
  glm::vec3 axis{0, 0, 1};  // unit, world
  float angle = 4;          // radians; pi or more: every direction
};
FacingCone facingCone(const Mesh& mesh, const glm::mat4& world_from_local);
// True only if the eye certainly sees nothing but back faces of what is in the box.
bool facesAway(const FacingCone& cone, const Bounds& world, const glm::vec3& eye);

// How finely a mesh's UVs are sampled: (UV -> world) is given per triangle by two singular values. Tile
// periods per metre, such that only 2 % of the area has fewer.
float uvDensity(const Mesh& mesh, const FlatBtfBinding& binding, const glm::mat4& world_from_local);

// Whether view rays need no following (loden_follow_surface): every triangle is flat, by its normals, and its
// UVs are `density` tile periods per metre in all directions.
bool isPlain(const Mesh& mesh, const FlatBtfBinding& binding, const glm::mat4& world_from_local,
             float density);

// The smallest lambda that any pixel of a visible object can ask for; see loden_lambda_from_footprint.
// `side`: reference texels per tile period.
float demandLambda(const View& view, const Bounds& world, float periods_per_metre, int side);

// Positions and targets at given times, interpolated by cubic Hermite curves whose slopes are the central
// differences (Catmull-Rom for unequal steps).
class CameraPath {
 public:
  struct Key {
    double t = 0;  // seconds, increasing
    glm::dvec3 position{0}, target{0, 0, -1};
  };
  // At least one key, in order of time.
  CameraPath(std::vector<Key> keys, Camera base);

  double duration() const { return keys_.back().t - keys_.front().t; }
  // At `seconds` since the first key, clamped to the path. Up and field of view are the base camera's.
  Camera at(double seconds) const;

 private:
  std::vector<Key> keys_;
  Camera base_;
};

}  // namespace loden::runtime
