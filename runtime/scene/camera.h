// Views of a scene: transforms, frustum, pixel footprints, and camera paths.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "material/model/analytic_surface.h"
#include "runtime/scene/scene.h"

namespace loden::runtime {

// A camera together with the size of its picture. Pixels correspond to cameraRay() of
// material/model/analytic_surface.h.
struct View {
  glm::mat4 clip_from_world{1};
  glm::vec3 position{0};       // world, metres
  glm::ivec2 size{1, 1};       // pixels
  float pixel_angle = 0.001f;  // metres across one pixel at 1 m distance from the camera's plane
  float edge_cosine = 1;       // cosine of the angle between the view axis and the picture's corners
};
struct DepthRange {
  double near_plane = 0.02, far_plane = 200;  // metres
};
View makeView(const Camera& camera, glm::ivec2 size, DepthRange depth = {});

// The view of a rectangle of the picture only, [from, to) in pixels from the bottom left, as a picture of
// that many pixels, or of `size` pixels.
View partOf(const View& view, glm::ivec2 from, glm::ivec2 to);
View partOf(const View& view, glm::ivec2 from, glm::ivec2 to, glm::ivec2 size);

// A camera of a glTF scene, converted to the Camera that makeView takes.
Camera cameraFromScene(const SceneCamera& camera);

// Six planes (xyz is the inward normal; xyz . p + w >= 0 inside).
using Frustum = std::array<glm::vec4, 6>;
Frustum frustumOf(const glm::mat4& clip_from_world);
// Whether the box may be visible: false only if it is certainly outside.
bool intersects(const Frustum& frustum, const Bounds& world);

// A cone that holds the directions that a mesh's front faces look in: all are within `angle` of `axis`.
struct FacingCone {
  glm::vec3 axis{0, 0, 1};  // unit, world
  float angle = 4;          // radians; pi or more: every direction
};
FacingCone facingCone(const Mesh& mesh, const glm::mat4& world_from_local);
// Whether the eye certainly sees only back faces of everything in the box.
bool facesAway(const FacingCone& cone, const Bounds& world, const glm::vec3& eye);

// Tile periods per metre of the mesh's UVs, such that only 2 % of the area has fewer. Per triangle they come
// from the two singular values of the map from UV to world.
float uvDensity(const Mesh& mesh, const FlatBtfBinding& binding, const glm::mat4& world_from_local);

// Texels of an image of `size` per metre of the mesh in its own frame, such that only 2 % of the area has
// fewer where the texture is used so; 0 where texture coordinates stand still. Square pixels that see the
// surface from any side read no finer mip than this asks for, but for that share.
float texelDensity(const Mesh& mesh, const TextureUse& use, glm::ivec2 size);
// A bound for how much the transform lengthens anything; exact for rotations and scales.
float mostStretch(const glm::mat3& linear);

// Whether look-ups on the mesh need not follow its surface (loden_follow_surface): every triangle is flat
// according to its normals, and its UVs have `density` tile periods per metre in all directions.
bool isPlain(const Mesh& mesh, const FlatBtfBinding& binding, const glm::mat4& world_from_local,
             float density);

// The smallest lambda that any pixel of a visible object can ask for, as loden_lambda_from_footprint computes
// it. `side`: reference texels per tile period. For a texture: texels per metre, and a side of 1.
float demandLambda(const View& view, const Bounds& world, float periods_per_metre, int side);

// A camera path: positions and targets at given times, interpolated by cubic Hermite curves whose slopes are
// central differences (Catmull-Rom for unequal steps).
class CameraPath {
 public:
  struct Key {
    double t = 0;  // seconds, increasing
    glm::dvec3 position{0}, target{0, 0, -1};
  };
  // `keys` holds at least one key, in order of time.
  CameraPath(std::vector<Key> keys, Camera base);

  double duration() const { return keys_.back().t - keys_.front().t; }
  // The camera at `seconds` since the first key, clamped to the path. Up vector and field of view are those
  // of the base camera.
  Camera at(double seconds) const;

 private:
  std::vector<Key> keys_;
  Camera base_;
};

}  // namespace loden::runtime
