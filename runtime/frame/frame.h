// The sample renderer: draws a scene with forward shading after a depth pre-pass, lit by a sun with a shadow
// map, point and spot lights, and an environment. Blended objects are drawn last, from back to front.
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
  kNeutral,  // Khronos PBR Neutral, which glTF viewers use
};

// False colours that show what a Loden material costs per pixel, in place of its look.
enum class HeatMap {
  kNone,
  kLambda,   // level of detail, from 0 to 8
  kFetches,  // texture instructions, from 0 to 100
  kTerms,    // red: near term, green: bands, blue: the mean alone
};

// How lambda, the level of detail, is computed per pixel: from the pixel's footprint on the surface, or from
// the distance to the camera alone (LBTF 3.4, step 2), in units of the distance at which a texel covers a
// pixel.
enum class LambdaRule { kFootprint, kDistance };

struct FrameSettings {
  // Draws glTF's own materials, as a viewer without Loden's extension does.
  bool base_materials_only = false;
  // Draws Loden materials whose geometry is a height field by parallax occlusion mapping (16 linear steps, 5
  // bisections), for comparison: their maps are read at the point that it finds, and the tile casts no
  // shadows on itself. Other materials, and those without a near term, are drawn as glTF's own.
  bool parallax_occlusion = false;
  bool shadows = true;  // shadows of the scene's sun
  // Shadows of the environment's brightest sun, where the scene has no sun of its own.
  bool environment_shadows = false;
  // Half width of the shadows' borders, in texels of the shadow map; above 1 they are soft.
  float shadow_width = 1;
  bool depth_prepass = true;
  bool cull = true;  // skips objects that are out of view or show only back faces; off for measuring
  // The depth buffer, point and spot lights and the sun's shadow map use the ray's hit below the reference
  // plane in place of the mesh, so that objects that stand in a relief's valleys are seen and lit. Costs a
  // VDIM look-up per texel of the shadow map and per pixel of the pre-pass.
  bool parallax_depth = false;
  // Needs parallax_depth. The mesh counts as the lowest level of the relief, not the highest, so that
  // silhouettes gain what sticks out. It is drawn as a shell: the mesh moved outwards along its normals by
  // the depth of the tile, and pixels whose rays miss the relief are discarded. The shell has gaps along hard
  // edges of the mesh.
  bool shell = false;
  // Samples per pixel, for smooth silhouettes: 1, 2, 4 or 8. Above 1 the frame is drawn into a framebuffer of
  // the renderer's own, of which only the colour is resolved into the target; the target's depth is then
  // neither cleared nor written.
  int samples = 1;
  LambdaRule lambda_rule = LambdaRule::kFootprint;
  std::optional<float> lambda;  // if set, the lambda of every pixel, in place of lambda_rule
  // The most costly shadows of the near term to draw: kNone leaves them out, kFast and kMap use look-ups of
  // fewer steps. A material that has a shadow map reads it unless this is kNone.
  Visibility visibility = Visibility::kDefault;
  Lookup lookup = Lookup::kDefault;  // the VDIM look-up of the near term: kFast or kDefault
  HeatMap heat = HeatMap::kNone;     // if not kNone, parallax_depth has no effect
  ToneCurve tone = ToneCurve::kFilmic;
  float exposure = 1;
  // What glTF's own materials reflect of the environment; all their environment light then comes from this
  // map.
  std::shared_ptr<const ReflectionMap> reflections;
  // The level of `reflections` to show behind the scene; if not set, `background` is shown.
  std::optional<float> sky_level;
  // Light from all around, in the world frame; of its suns at most SCENE_MAX_SUNS are used. If not set,
  // sky_ambient and ground_ambient light the scene.
  std::optional<Environment> environment;
  glm::vec3 sky_ambient{0.55f, 0.6f, 0.7f};      // irradiance from above (y is up), linear RGB
  glm::vec3 ground_ambient{0.25f, 0.22f, 0.2f};  // irradiance from below, linear RGB
  glm::vec3 background{0.02f, 0.022f, 0.026f};   // linear RGB
};

// The level of detail that one frame wanted of a material or a texture, and the one it got.
struct MaterialDemand {
  std::string name;
  float lambda = 0;    // the finest level that the view asked for
  float resident = 0;  // the finest level that the shader could use
};

struct FrameStats {
  int objects = 0, visible_objects = 0;
  int draw_calls = 0;        // in the shading pass
  int depth_draw_calls = 0;  // in the depth pre-pass and for the shadow map
  int program_changes = 0;
  uint64_t triangles = 0;               // in the shading pass
  std::vector<MaterialDemand> demands;  // visible materials only
  // Textures of glTF's own materials that are seen, or cut out what throws a shadow.
  std::vector<MaterialDemand> textures;
};

// The framebuffer that a frame is drawn into: its GL name (0 is the window) and its size in pixels. The frame
// goes into its first draw buffer; the contents of others are undefined afterwards.
struct FrameTarget {
  uint32_t framebuffer = 0;
  glm::ivec2 size{0};
};

// A scene on the GPU and the passes that draw it. It does not outlive its GL context: destroy it before
// Device::recreate() and create another afterwards. Call per frame: prepare(), then MaterialSystem::update()
// or finishLoading(), then draw().
class FrameRenderer {
 public:
  // A renderer of the scene. Uploads the meshes, opens the scene's assets and has its images streamed as
  // textures; both are unloaded with the renderer. The images need not stay in the scene, but a copy with
  // mips stays in memory. The device must be current here and when the renderer is destroyed; device, shaders
  // and materials must outlive the renderer. Issues: those of MaterialSystem::load.
  static Result<std::unique_ptr<FrameRenderer>> create(const Device& device, ShaderLibrary& shaders,
                                                       MaterialSystem& materials, const Scene& scene);
  ~FrameRenderer();
  FrameRenderer(const FrameRenderer&) = delete;
  FrameRenderer& operator=(const FrameRenderer&) = delete;

  // Moves nodes, skins, morph targets and lights, and what is attached to them, to the pose. The scene must
  // be the one given to create(), but its images need not be there any more. Leaves GL state as it was.
  void pose(const Scene& scene, const ScenePose& pose);
  // Uses the Loden materials that are now bound to the scene's materials, after a caller has changed bindings
  // or appended assets. The scene must be the one given to create(), with or without its images. Leaves GL
  // state as it was. Issues: those of MaterialSystem::load.
  Status dress(const Scene& scene, const ScenePose& pose);
  // Finds the visible objects and demands their materials and textures from the MaterialSystem. Makes no GL
  // call.
  void prepare(const View& view, const FrameSettings& settings);
  // Draws what prepare() found; draws nothing if the target's size is 0. Leaves GL state as it was. Issues:
  // those of ShaderLibrary::program; kMemory if the driver has no room for the samples.
  Status draw(const FrameTarget& target);
  // Waits until the GPU has drawn everything; used for measuring.
  void finish() const;

  // Numbers about the last frame that was prepared or drawn.
  const FrameStats& stats() const;
  // The materials of Scene::assets, in that order.
  std::vector<MaterialId> assets() const;
  // A number that changes whenever materials and textures of the last frame would now be shown in other
  // detail.
  uint64_t detailRevision() const;
  // The box around all instances, in the world frame.
  Bounds bounds() const;

 private:
  struct Impl;
  explicit FrameRenderer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace loden::runtime
