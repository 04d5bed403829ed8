// Draws a scene: forward shading with a depth pre-pass, a sun with a shadow map, point and spot lights, and
// light from all around; what is blended comes last, from back to front.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "material/base/result.h"
#include "material/model/environment.h"
#include "runtime/gl/device.h"
#include "runtime/gl/material/material_system.h"
#include "runtime/scene/animation.h"
#include "runtime/scene/camera.h"
#include "runtime/scene/reflections.h"
#include "runtime/scene/scene.h"
#include "runtime/shader/shader_library.h"

namespace loden::runtime {

enum class ToneCurve {
  kClip,
  kFilmic,
  kNeutral,  // as glTF's viewers have it: Khronos PBR Neutral
};

// Colours that tell of a Loden material's cost in place of its look.
enum class HeatMap {
  kNone,
  kLambda,   // level of detail, from 0 to 8
  kFetches,  // texture instructions, from 0 to 100
  kTerms,    // red: near term, green: bands, blue: the mean alone
};

// Where lambda comes from: the pixel's footprint on the surface, or its distance alone, as LBTF 3.4, step 2
// has it, in units at which a texel covers a pixel.
enum class LambdaRule { kFootprint, kDistance };

struct FrameSettings {
  bool base_materials_only = false;  // glTF's own materials, as a viewer without the extension shows them
  // What engines have instead, to compare with: height fields by parallax occlusion mapping (16 linear steps,
  // 5 bisections), their maps at the point that it finds and no shadows in the tile; other materials, and
  // those without a near term, as glTF's own.
  bool parallax_occlusion = false;
  bool shadows = true;  // of the scene's sun
  // Of the environment's brightest sun, where the scene has none of its own.
  bool environment_shadows = false;
  float shadow_width = 1;  // half width of the shadows' borders, texels of the map; above 1 they are soft
  bool depth_prepass = true;
  bool cull = true;  // leaves out what is not in view or shows its back; off for measuring
  // Depth, lamps and the sun's shadow map at the hit below the reference plane, so that what stands in a
  // relief's valleys is seen and lit. Costs a lookup per texel of the shadow map and per pixel of the
  // pre-pass.
  bool parallax_depth = false;
  // With parallax_depth: a mesh is where its relief is lowest, not highest, so that silhouettes gain what
  // sticks out. Drawn as a shell: the mesh moved out along its normals by the depth of the tile, less what
  // rays do not meet. Meshes with hard edges gape there.
  bool shell = false;
  // Per pixel, for silhouettes; 1, 2, 4 or 8. Above 1 the frame is drawn elsewhere and its colour alone
  // resolved into the target, whose depth is neither cleared nor written.
  int samples = 1;
  LambdaRule lambda_rule = LambdaRule::kFootprint;
  std::optional<float> lambda;  // instead, everywhere
  // At most: kNone leaves shadows of the near term out, kFast and kMap look up in fewer steps. What has a
  // shadow map keeps reading it.
  Visibility visibility = Visibility::kDefault;
  Lookup lookup = Lookup::kDefault;  // kFast or kDefault
  HeatMap heat = HeatMap::kNone;     // without parallax_depth
  ToneCurve tone = ToneCurve::kFilmic;
  float exposure = 1;
  // What glTF's own materials mirror of the environment; their light is then that of the map alone.
  std::shared_ptr<const ReflectionMap> reflections;
  std::optional<float> sky_level;  // the level of that map to show behind everything; none: the background
  // Light from all around, world frame; at most SCENE_MAX_SUNS suns count. None: a sky and a ground.
  std::optional<Environment> environment;
  glm::vec3 sky_ambient{0.55f, 0.6f, 0.7f};      // irradiance from above, linear RGB; y is up
  glm::vec3 ground_ambient{0.25f, 0.22f, 0.2f};  // and from below
  glm::vec3 background{0.02f, 0.022f, 0.026f};   // linear RGB
};

// What one material was asked for in a frame.
struct MaterialDemand {
  std::string name;
  float lambda = 0;    // asked for
  float resident = 0;  // what the shader was given
};

struct FrameStats {
  int objects = 0, visible_objects = 0;
  int draw_calls = 0;        // of the shading pass
  int depth_draw_calls = 0;  // of the pre-pass and the shadow map
  int program_changes = 0;
  uint64_t triangles = 0;               // of the shading pass
  std::vector<MaterialDemand> demands;  // visible materials only
};

// Where a frame goes: a framebuffer's GL name (0: the window) and its size in pixels. Its first draw buffer
// is drawn; what others hold afterwards is undefined.
struct FrameTarget {
  uint32_t framebuffer = 0;
  glm::ivec2 size{0};
};

// One scene on the GPU. Destroy it before Device::recreate() and make another afterwards: it does not outlive
// its context, as a MaterialSystem does. Per frame: prepare(), then MaterialSystem::update() or
// finishLoading(), then draw().
class FrameRenderer {
 public:
  // Uploads the meshes and opens the scene's assets, which are unloaded with the renderer. The device must be
  // current, here and at the end; device, shaders and materials must outlive the renderer. Issues of
  // MaterialSystem::load.
  static Result<std::unique_ptr<FrameRenderer>> create(const Device& device, ShaderLibrary& shaders,
                                                       MaterialSystem& materials, const Scene& scene);
  ~FrameRenderer();
  FrameRenderer(const FrameRenderer&) = delete;
  FrameRenderer& operator=(const FrameRenderer&) = delete;

  // Moves nodes, skins, morph targets, lights and what hangs on them. The scene must be the one that was
  // given to create(), but for its images, which may be gone. Leaves GL state as it was.
  void pose(const Scene& scene, const ScenePose& pose);
  // Takes over the Loden materials that the scene's materials have by now: other bindings, and assets behind
  // those that there were. The scene is as for pose(), and so is GL state. Issues of MaterialSystem::load.
  Status dress(const Scene& scene, const ScenePose& pose);
  // Finds what the view sees and demands its materials. No GL call.
  void prepare(const View& view, const FrameSettings& settings);
  // Draws what was prepared; nothing into an empty target. GL state is as before afterwards. Issues of
  // ShaderLibrary::program; kMemory where the driver has no room for the samples.
  Status draw(const FrameTarget& target);
  // Waits until the GPU has drawn everything; for measuring.
  void finish() const;

  // Of the last frame prepared or drawn.
  const FrameStats& stats() const;
  // The scene's assets, in its order.
  std::vector<MaterialId> assets() const;
  // Changes whenever what the last frame showed of its materials would now be shown in other detail.
  uint64_t detailRevision() const;
  // Around all instances, world.
  Bounds bounds() const;

 private:
  struct Impl;
  explicit FrameRenderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace loden::runtime
