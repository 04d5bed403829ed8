#include "runtime/frame/frame.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <tuple>

#include "material/base/issues.h"
#include "material/model/directions.h"
#include "runtime/frame/frame_multisample.h"
#include "runtime/frame/frame_programs.h"
#include "runtime/frame/frame_shadow.h"
#include "runtime/frame/image_light.h"
#include "runtime/frame/scene_gpu.h"
#include "runtime/gl/gl_objects.h"
#include "runtime/gl/gl_state.h"
#include "shaders/loden_shared.h"
#include "shaders/scene_shared.h"

namespace loden::runtime {
namespace {

constexpr int kUnits = SCENE_UNIT_SHADOW + 1;
constexpr int kUniformBindings = SCENE_BLOCK_BASE_MATERIAL + 1;

// What the sun's shadow map shows beside the meshes. A new pose makes it void.
struct ShadowRelief {
  glm::vec3 direction{0};  // of the sun
  uint64_t masks = 0;      // changes with the textures that cut objects out
  bool shown = false;      // else all objects are as their meshes are, and the rest is as here
  bool shell = false;
  uint64_t revision = 0;  // MaterialSystem::reliefRevision
  std::optional<float> lambda;
  friend bool operator==(const ShadowRelief&, const ShadowRelief&) = default;
};

// The faces of an object that a draw shows.
enum class Faces { kFront, kBack, kAsMaterial };

// A visible object.
struct Drawable {
  int object = 0;
  float distance = 0;    // of its bounds to the camera
  float lambda = -1e9f;  // none of its pixels shows a finer level, if that is known
};

SceneLight lightData(const Light& light) {
  return {glm::vec4(light.position, light.range),
          glm::vec4(light.intensity, light.kind == LightKind::kSpot ? 1.0f : 0.0f),
          glm::vec4(light.direction, light.cos_outer), glm::vec4(light.cos_inner, 0, 0, 0)};
}

// The polynomial as nine vectors; whether it gives any light.
bool setPolynomial(const EnvironmentLight& light, vec4* data) {
  bool lit = false;
  for (int c = 0; c < 3; ++c) {
    const glm::mat3& m = light.quadratic[c];
    data[3 * c] = glm::vec4(light.linear[c], light.constant[c]);
    data[3 * c + 1] = {m[0][0], m[1][1], m[2][2], 0};
    data[3 * c + 2] = {m[0][1], m[0][2], m[1][2], 0};
    for (int k = 0; k < 3; ++k) lit = lit || data[3 * c + k] != glm::vec4(0);
  }
  return lit;
}

void setEnvironment(const Environment& environment, const ReflectionMap* reflections, SceneFrame& data) {
  bool lit = setPolynomial(environment.light, data.environment);
  const EnvironmentLight& base = reflections ? reflections->light : environment.light;
  lit = setPolynomial(base, data.base_environment) || lit;
  data.flags.w = reflections ? ReflectionMap::kLevels : 0;
  data.flags.y = static_cast<int>(std::min<size_t>(environment.suns.size(), SCENE_MAX_SUNS));
  data.flags.z = lit ? 1 : 0;
  for (int k = 0; k < data.flags.y; ++k) {
    data.environment_suns[2 * k] = glm::vec4(environment.suns[k].direction, 0);
    data.environment_suns[2 * k + 1] = glm::vec4(environment.suns[k].irradiance * static_cast<float>(kPi), 0);
  }
}

// The shadow map lies behind the units of every material.
Status checkUnits(const GpuScene& scene, const Device& device, const MaterialSystem& materials) {
  const int available = device.capabilities().max_fragment_textures;
  if (available <= SCENE_UNIT_SHADOW)
    return Issue{
        issue_id::kGlContext, Severity::kError, "frame",
        "the sample renderer needs 30 texture units, and the driver has " + std::to_string(available)};
  for (const auto& asset : scene.assets) {
    const MaterialVariant variant = materials.variant(asset.material.id());
    if (variant.first_unit + unitsOf(variant) > SCENE_UNIT_SHADOW)
      return Issue{issue_id::kOption, Severity::kError, asset.name,
                   "takes the shadow map's texture unit; make the material system with a lower first_unit"};
  }
  return {};
}

GlBuffer makeFrameUniforms(const char* label) {
  return makeBuffer(sizeof(SceneFrame), {}, GL_DYNAMIC_STORAGE_BIT, label);
}

void setViewport(glm::ivec2 size) {
  glViewportIndexedf(0, 0, 0, float(size.x), float(size.y));
}

void setColorMask(GLboolean write) {
  glColorMaski(0, write, write, write, write);
}

// What every pass relies on; the caller's state is restored by GlDrawStateScope, which must know all of it.
// Of draw buffers and viewports only the first is used, and set.
void setPassState() {
  glDisablei(GL_BLEND, 0);
  glDisablei(GL_SCISSOR_TEST, 0);
  glDisable(GL_STENCIL_TEST);
  glDisable(GL_DEPTH_CLAMP);
  glDisable(GL_RASTERIZER_DISCARD);
  glDisable(GL_COLOR_LOGIC_OP);
  glDisable(GL_PRIMITIVE_RESTART);
  glDisable(GL_PRIMITIVE_RESTART_FIXED_INDEX);
  glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  glDisable(GL_SAMPLE_COVERAGE);
  glDisable(GL_SAMPLE_MASK);
  glDisable(GL_SAMPLE_SHADING);
  glDisable(GL_POLYGON_OFFSET_FILL);
  glDisable(GL_POLYGON_SMOOTH);
  for (GLuint plane = 0; plane < 8; ++plane) glDisable(GL_CLIP_DISTANCE0 + plane);
  glEnable(GL_MULTISAMPLE);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_FRAMEBUFFER_SRGB);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
  glBlendEquationSeparatei(0, GL_FUNC_ADD, GL_FUNC_ADD);
  glBlendFuncSeparatei(0, GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA, GL_ONE, GL_ONE_MINUS_SRC_ALPHA);
  glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  glDepthRangeIndexed(0, 0, 1);
  glClearDepth(1);
  glCullFace(GL_BACK);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  setColorMask(GL_TRUE);
  glBindSampler(SCENE_UNIT_SHADOW, 0);
}

}  // namespace

struct FrameRenderer::Impl {
  const Device& device;
  ShaderLibrary& shaders;
  MaterialSystem& materials;
  GpuScene scene;
  GlBuffer frame_uniforms, shadow_uniforms;
  ShadowMap shadow;
  std::optional<ShadowRelief> shadow_drawn;
  MultisampleTarget multisample;
  ImageLight image_light;
  GlVertexArray no_vertices;  // of what the vertex shader makes up
  SunView sun_view;           // of the light that throws the shadows

  View view;
  FrameSettings settings;
  std::vector<Drawable> visible;
  std::vector<MaterialId> demanded;          // parallel to stats.demands
  std::vector<TextureId> demanded_textures;  // parallel to stats.textures
  FrameStats stats;
  FramePrograms programs{shaders, materials, scene, image_light, settings};

  float shellDepth(int object) const;
  Bounds shownBounds(int object) const;
  Bounds shownBounds() const;
  void findVisible();
  void demandMaterials();
  float textureLambda(const Object& object, float texels_per_metre) const;
  void demandTextures();
  uint64_t maskRevision() const;

  SceneFrame frameData() const;
  void uploadUniforms();
  void drawObject(int object, Faces faces = Faces::kAsMaterial) const;
  std::optional<glm::vec3> shadowSun() const;
  ShadowRelief shadowRelief() const;
  Status drawShadowMap();
  Status drawDepth();
  Status drawShaded();
  Status drawBlended();
  Status drawSky();
  Status drawView(const FrameTarget& target);
};

// How far the object's reference surface lies above its mesh, metres.
float FrameRenderer::Impl::shellDepth(int index) const {
  const MaterialId id = programs.materialOf(index);
  if (!settings.shell || !programs.movesDepth(id)) return 0;
  return materials.material(id).geometry.range.z / scene.objects[index].periods_per_metre;
}

Bounds FrameRenderer::Impl::shownBounds(int index) const {
  const Bounds& box = scene.objects[index].bounds;
  const float depth = shellDepth(index);
  return {box.min - depth, box.max + depth};
}

// Of all objects.
Bounds FrameRenderer::Impl::shownBounds() const {
  float depth = 0;
  for (int i = 0; settings.shell && i < static_cast<int>(scene.objects.size()); ++i)
    depth = std::max(depth, shellDepth(i));
  return {scene.bounds.min - depth, scene.bounds.max + depth};
}

// Front to back.
void FrameRenderer::Impl::findVisible() {
  const Frustum frustum = frustumOf(view.clip_from_world);
  visible.clear();
  for (size_t i = 0; i < scene.objects.size(); ++i) {
    const Bounds box = shownBounds(static_cast<int>(i));
    const bool seen = intersects(frustum, box) && !facesAway(scene.objects[i].facing, box, view.position);
    if (settings.cull && !seen) continue;
    visible.push_back(
        {static_cast<int>(i), glm::distance(view.position, glm::clamp(view.position, box.min, box.max))});
  }
  std::stable_sort(visible.begin(), visible.end(),
                   [](const Drawable& a, const Drawable& b) { return a.distance < b.distance; });
}

void FrameRenderer::Impl::demandMaterials() {
  demanded.clear();
  if (settings.base_materials_only) return;
  std::vector<std::optional<float>> asked(scene.assets.size());
  for (Drawable& drawable : visible) {
    const Object& object = scene.objects[drawable.object];
    if (!programs.materialOf(drawable.object)) continue;
    const Material& material = materials.material(scene.assets[object.asset].material.id());
    float lambda =
        settings.lambda.value_or(demandLambda(view, object.bounds, object.periods_per_metre, material.side));
    drawable.lambda = lambda;
    if (settings.parallax_occlusion) lambda = std::min(lambda, material.surface->fade_begin);
    std::optional<float>& least = asked[object.asset];
    least = std::min(least.value_or(lambda), lambda);
  }
  for (size_t i = 0; i < asked.size(); ++i) {
    if (!asked[i]) continue;
    materials.demand(scene.assets[i].material.id(), *asked[i]);
    demanded.push_back(scene.assets[i].material.id());
    stats.demands.push_back(
        {scene.assets[i].name, *asked[i], materials.residentLambda(scene.assets[i].material.id())});
  }
}

// The finest mip that the object shows.
float FrameRenderer::Impl::textureLambda(const Object& object, float texels_per_metre) const {
  const float stretch = std::max(mostStretch(glm::mat3(object.world_from_local)), 1e-20f);
  return demandLambda(view, object.bounds, texels_per_metre / stretch, 1);
}

// Those of base materials, and of alpha masks in the shadow map, where objects count that are out of view.
void FrameRenderer::Impl::demandTextures() {
  const auto& textures = scene.base_materials.textures();
  std::vector<std::optional<float>> asked(textures.size());
  const auto ask = [&asked](int texture, float lambda) {
    std::optional<float>& least = asked[size_t(texture)];
    least = std::min(least.value_or(lambda), lambda);
  };
  for (const Drawable& drawable : visible) {
    const Object& object = scene.objects[drawable.object];
    if (programs.materialOf(drawable.object)) continue;
    for (const TextureNeed& need : scene.needs[object.needs])
      ask(need.texture, textureLambda(object, need.texels_per_metre));
  }
  for (int i = 0; shadowSun() && i < static_cast<int>(scene.objects.size()); ++i) {
    const Object& object = scene.objects[i];
    const int mask = programs.materialOf(i) ? -1 : scene.base_materials.maskTexture(object.base_material);
    for (const TextureNeed& need : scene.needs[object.needs]) {
      if (need.texture != mask) continue;
      const float stretch = std::max(mostStretch(glm::mat3(object.world_from_local)), 1e-20f);
      ask(mask, std::max(std::log2(sun_view.texel * need.texels_per_metre / stretch), 0.0f));
    }
  }
  demanded_textures.clear();
  for (size_t i = 0; i < asked.size(); ++i) {
    if (!asked[i]) continue;
    const TextureId id = textures[i].id.id();
    materials.demand(id, *asked[i]);
    demanded_textures.push_back(id);
    stats.textures.push_back({textures[i].name, *asked[i], materials.residentLambda(id)});
  }
}

uint64_t FrameRenderer::Impl::maskRevision() const {
  uint64_t hash = 0;
  for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i) {
    const int mask =
        programs.materialOf(i) ? -1 : scene.base_materials.maskTexture(scene.objects[i].base_material);
    if (mask < 0) continue;
    const float shown = materials.residentLambda(scene.base_materials.textures()[size_t(mask)].id.id());
    hash = hash * 1099511628211u + std::bit_cast<uint32_t>(shown);
  }
  return hash;
}

SceneFrame FrameRenderer::Impl::frameData() const {
  SceneFrame data{};
  data.clip_from_world = view.clip_from_world;
  data.shadow_from_world = sun_view.texture_from_world;
  data.camera_exposure = glm::vec4(view.position, settings.exposure);
  const std::optional<glm::vec3> shadow_sun = shadowSun();
  if (scene.sun) {
    data.sun_direction = glm::vec4(-scene.sun->direction, sun_view.texel);
    data.sun_irradiance = glm::vec4(scene.sun->intensity, settings.shadow_width);
  } else if (shadow_sun) {
    data.sun_direction = glm::vec4(-*shadow_sun, sun_view.texel);
    data.sun_irradiance.w = settings.shadow_width;
    data.flags.x = SCENE_ENVIRONMENT_SHADOW;
  }
  data.flags.x |= (scene.sun ? SCENE_SUN : 0) | (shadow_sun ? SCENE_SHADOWS : 0) |
                  (settings.tone == ToneCurve::kFilmic ? SCENE_FILMIC : 0) |
                  (settings.tone == ToneCurve::kNeutral ? SCENE_NEUTRAL : 0) |
                  (settings.lambda ? SCENE_LAMBDA_OVERRIDE : 0) | (settings.shell ? SCENE_SHELL : 0) |
                  (settings.lambda_rule == LambdaRule::kDistance ? SCENE_LAMBDA_DISTANCE : 0);
  const Environment sky{skyLight(settings.sky_ambient, settings.ground_ambient, {0, 1, 0}), {}};
  setEnvironment(settings.environment ? *settings.environment : sky, settings.reflections.get(), data);
  data.lambda = glm::vec4(settings.lambda.value_or(0), view.pixel_angle, float(settings.heat),
                          settings.sky_level.value_or(0));
  std::transform(scene.lights.begin(), scene.lights.end(), data.lights, lightData);
  return data;
}

void FrameRenderer::Impl::uploadUniforms() {
  SceneFrame frame = frameData();
  glNamedBufferSubData(frame_uniforms.name(), 0, sizeof frame, &frame);
  frame.clip_from_world = sun_view.clip_from_world;
  frame.flags.x |= SCENE_SUN_VIEW;
  glNamedBufferSubData(shadow_uniforms.name(), 0, sizeof frame, &frame);
}

void FrameRenderer::Impl::drawObject(int index, Faces faces) const {
  const Object& object = scene.objects[index];
  const GpuMesh& mesh = scene.meshes[object.mesh];
  glBindBufferRange(GL_UNIFORM_BUFFER, SCENE_BLOCK_OBJECT, scene.object_uniforms.name(),
                    GLintptr(size_t(index) * scene.object_stride), sizeof(SceneObject));
  glFrontFace(object.mirrored ? GL_CW : GL_CCW);
  if (object.double_sided && faces == Faces::kAsMaterial)
    glDisable(GL_CULL_FACE);
  else
    glEnable(GL_CULL_FACE);
  glCullFace(faces == Faces::kBack ? GL_FRONT : GL_BACK);
  glBindVertexArray(mesh.array.name());
  glDrawElements(GL_TRIANGLES, mesh.index_count, GL_UNSIGNED_INT, nullptr);
}

ShadowRelief FrameRenderer::Impl::shadowRelief() const {
  ShadowRelief relief;
  relief.direction = shadowSun().value_or(glm::vec3(0));
  relief.masks = maskRevision();
  if (!settings.parallax_depth || settings.parallax_occlusion || settings.base_materials_only) return relief;
  return {relief.direction, relief.masks, true, settings.shell, materials.reliefRevision(), settings.lambda};
}

// The way that the light travels that throws the shadows; none: nothing throws any.
std::optional<glm::vec3> FrameRenderer::Impl::shadowSun() const {
  if (scene.sun) return settings.shadows ? std::optional(scene.sun->direction) : std::nullopt;
  if (!settings.environment_shadows || !settings.environment || settings.environment->suns.empty()) return {};
  return -settings.environment->suns[0].direction;
}

Status FrameRenderer::Impl::drawShadowMap() {
  if (!shadowSun() || shadow_drawn == shadowRelief()) return {};
  const GlDebugGroup group("sun shadow");
  if (!shadow.depth) shadow = makeShadowMap();
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, shadow.framebuffer.name());
  setViewport(glm::ivec2(ShadowMap::kSide));
  glClear(GL_DEPTH_BUFFER_BIT);
  glBindBufferBase(GL_UNIFORM_BUFFER, SCENE_BLOCK_FRAME, shadow_uniforms.name());
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(2.0f, 2.0f);
  PassProgram current;
  for (int i = 0; i < static_cast<int>(scene.objects.size()); ++i) {
    if (programs.alphaMode(i) == AlphaMode::kBlend) continue;
    if (Status status = programs.useForDepth(i, current); !status) return status;
    drawObject(i);
    ++stats.depth_draw_calls;
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  shadow_drawn = shadowRelief();
  return {};
}

Status FrameRenderer::Impl::drawDepth() {
  if (!settings.depth_prepass) return {};
  const GlDebugGroup group("depth pre-pass");
  setColorMask(GL_FALSE);
  PassProgram current;
  for (const Drawable& drawable : visible) {
    if (programs.alphaMode(drawable.object) == AlphaMode::kBlend) continue;
    if (Status status = programs.useForDepth(drawable.object, current); !status) return status;
    drawObject(drawable.object);
    ++stats.depth_draw_calls;
  }
  setColorMask(GL_TRUE);
  return {};
}

// By material and the way its surface is looked up, front to back within each.
Status FrameRenderer::Impl::drawShaded() {
  const GlDebugGroup group("shading");
  std::vector<Drawable> order = visible;
  const auto key = [&](const Drawable& drawable) {
    const Object& object = scene.objects[drawable.object];
    const MaterialId id = programs.materialOf(drawable.object);
    return std::tuple(id.value, object.curved, id ? 0 : object.base_material);
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](const Drawable& a, const Drawable& b) { return key(a) < key(b); });
  glDepthFunc(GL_LEQUAL);
  PassProgram current;
  for (const Drawable& drawable : order) {
    if (programs.alphaMode(drawable.object) == AlphaMode::kBlend) continue;
    if (Status status = programs.useForShading(drawable.object, drawable.lambda, current); !status)
      return status;
    drawObject(drawable.object);
    ++stats.draw_calls;
    stats.triangles += uint64_t(scene.meshes[scene.objects[drawable.object].mesh].index_count) / 3;
  }
  stats.program_changes += current.changes;
  return {};
}

// Back to front by the objects' middles; of objects with two sides the far ones first.
Status FrameRenderer::Impl::drawBlended() {
  std::vector<Drawable> order;
  for (const Drawable& drawable : visible)
    if (programs.alphaMode(drawable.object) == AlphaMode::kBlend)
      order.push_back(
          {drawable.object, glm::distance(view.position, scene.objects[drawable.object].bounds.centre())});
  if (order.empty()) return {};
  const GlDebugGroup group("blending");
  std::stable_sort(order.begin(), order.end(),
                   [](const Drawable& a, const Drawable& b) { return a.distance > b.distance; });
  glEnablei(GL_BLEND, 0);
  glDepthMask(GL_FALSE);
  PassProgram current;
  for (const Drawable& drawable : order) {
    if (Status status = programs.useForShading(drawable.object, drawable.lambda, current); !status)
      return status;
    if (scene.objects[drawable.object].double_sided) drawObject(drawable.object, Faces::kBack);
    drawObject(drawable.object, Faces::kFront);
    ++stats.draw_calls;
    stats.triangles += uint64_t(scene.meshes[scene.objects[drawable.object].mesh].index_count) / 3;
  }
  glDepthMask(GL_TRUE);
  glDisablei(GL_BLEND, 0);
  stats.program_changes += current.changes;
  return {};
}

// Behind what has been drawn.
Status FrameRenderer::Impl::drawSky() {
  if (!settings.sky_level || !settings.reflections) return {};
  const GlDebugGroup group("sky");
  PassProgram current;
  if (Status status = programs.use("scene_sky", current); !status) return status;
  image_light.bind();
  if (!no_vertices) no_vertices = makeVertexArray("sky");
  glBindVertexArray(no_vertices.name());
  glDisable(GL_CULL_FACE);
  glDepthFunc(GL_LEQUAL);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  return {};
}

Status FrameRenderer::Impl::drawView(const FrameTarget& target) {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target.framebuffer);
  setViewport(target.size);
  glClearColor(settings.background.r, settings.background.g, settings.background.b, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glBindBufferBase(GL_UNIFORM_BUFFER, SCENE_BLOCK_FRAME, frame_uniforms.name());
  if (shadow_drawn) glBindTextureUnit(SCENE_UNIT_SHADOW, shadow.depth.name());
  image_light.show(settings.reflections);
  if (Status status = drawDepth(); !status) return status;
  if (Status status = drawShaded(); !status) return status;
  if (Status status = drawSky(); !status) return status;
  return drawBlended();
}

FrameRenderer::FrameRenderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FrameRenderer::~FrameRenderer() = default;

Result<std::unique_ptr<FrameRenderer>> FrameRenderer::create(const Device& device, ShaderLibrary& shaders,
                                                             MaterialSystem& materials, const Scene& scene) {
  const GlDrawStateScope scope(0, 0);
  auto gpu = uploadScene(scene, device, materials);
  if (!gpu) return gpu.issue();
  if (const Status status = checkUnits(*gpu, device, materials); !status) return status.issue();
  auto impl = std::unique_ptr<Impl>(new Impl{device,
                                             shaders,
                                             materials,
                                             std::move(gpu.value()),
                                             makeFrameUniforms("frame uniforms"),
                                             makeFrameUniforms("shadow uniforms"),
                                             {},
                                             {},
                                             {},
                                             {},
                                             {},
                                             {},
                                             {},
                                             {},
                                             {},
                                             {},
                                             {},
                                             {}});
  return std::unique_ptr<FrameRenderer>(new FrameRenderer(std::move(impl)));
}

void FrameRenderer::pose(const Scene& scene, const ScenePose& pose) {
  if (poseScene(scene, pose, impl_->scene)) impl_->shadow_drawn.reset();
}

Status FrameRenderer::dress(const Scene& scene, const ScenePose& pose) {
  const GlPixelStateScope scope;
  if (Status status = dressScene(scene, pose, impl_->materials, impl_->scene); !status) return status;
  impl_->shadow_drawn.reset();
  return checkUnits(impl_->scene, impl_->device, impl_->materials);
}

void FrameRenderer::prepare(const View& view, const FrameSettings& settings) {
  impl_->view = view;
  impl_->settings = settings;
  impl_->stats = {};
  impl_->findVisible();
  impl_->stats.objects = static_cast<int>(impl_->scene.objects.size());
  impl_->stats.visible_objects = static_cast<int>(impl_->visible.size());
  if (const auto sun = impl_->shadowSun())
    impl_->sun_view = sunView(impl_->shownBounds(), *sun, ShadowMap::kSide);
  impl_->demandMaterials();
  impl_->demandTextures();
}

Status FrameRenderer::draw(const FrameTarget& target) {
  Impl& self = *impl_;
  if (target.size.x < 1 || target.size.y < 1) return {};  // a minimised window
  const GlDrawStateScope scope(kUnits, kUniformBindings);
  self.uploadUniforms();
  setPassState();
  if (Status status = self.drawShadowMap(); !status) return status;

  const bool sampled = self.settings.samples > 1;
  if (sampled && !fits(self.multisample, target.size, self.settings.samples, target.framebuffer)) {
    self.multisample = {};
    Result<MultisampleTarget> made =
        makeMultisampleTarget(target.size, self.settings.samples, target.framebuffer);
    if (!made) return made.issue();
    self.multisample = std::move(made.value());
  }
  const FrameTarget view = sampled ? FrameTarget{self.multisample.framebuffer.name(), target.size} : target;
  if (Status status = self.drawView(view); !status) return status;
  if (sampled) resolve(self.multisample, target.framebuffer);

  for (size_t i = 0; i < self.demanded.size(); ++i)
    self.stats.demands[i].resident = self.materials.residentLambda(self.demanded[i]);
  for (size_t i = 0; i < self.demanded_textures.size(); ++i)
    self.stats.textures[i].resident = self.materials.residentLambda(self.demanded_textures[i]);
  return {};
}

std::vector<MaterialId> FrameRenderer::assets() const {
  std::vector<MaterialId> ids;
  for (const Asset& asset : impl_->scene.assets) ids.push_back(asset.material.id());
  return ids;
}

uint64_t FrameRenderer::detailRevision() const {
  uint64_t hash = impl_->materials.reliefRevision();
  const auto add = [&hash](float lambda) { hash = hash * 1099511628211u + std::bit_cast<uint32_t>(lambda); };
  for (const MaterialId id : impl_->demanded) add(impl_->materials.residentLambda(id));
  for (const TextureId id : impl_->demanded_textures) add(impl_->materials.residentLambda(id));
  return hash;
}

void FrameRenderer::finish() const {
  glFinish();
}

const FrameStats& FrameRenderer::stats() const {
  return impl_->stats;
}
Bounds FrameRenderer::bounds() const {
  return impl_->scene.bounds;
}

}  // namespace loden::runtime
