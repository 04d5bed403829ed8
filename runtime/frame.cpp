#include "runtime/frame.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <cstring>
#include <span>

#include "material/issues.h"
#include "runtime/frame_multisample.h"
#include "runtime/frame_shadow.h"
#include "runtime/gl_objects.h"
#include "runtime/gl_state.h"
#include "runtime/scene_gpu.h"
#include "shaders/loden_shared.h"
#include "shaders/scene_shared.h"

namespace loden::runtime {
namespace {

constexpr int kUnits = SCENE_UNIT_SHADOW + 1;
constexpr int kUniformBindings = SCENE_BLOCK_OBJECT + 1;

// An instance as the loop sees it.
struct Object {
  int mesh = 0;
  SceneMaterial surface;
  MaterialId material;          // none: drawn with its base material
  float periods_per_metre = 1;
  Bounds bounds;                // world
  SceneObject data{};           // but for its lights
  bool mirrored = false;
};

// What one frame draws: objects by index, in drawing order.
struct Drawable {
  int object = 0;
  float distance = 0;
};

// Solid angle aside, whether a light's sphere of influence touches the box.
bool reaches(const Light& light, const Bounds& bounds) {
  if (light.range <= 0) return true;
  const glm::vec3 nearest = glm::clamp(light.position, bounds.min, bounds.max);
  return glm::distance(nearest, light.position) < light.range;
}

SceneLight lightData(const Light& light) {
  return {glm::vec4(light.position, light.range),
          glm::vec4(light.intensity, light.kind == LightKind::kSpot ? 1.0f : 0.0f),
          glm::vec4(light.direction, light.cos_outer), glm::vec4(light.cos_inner, 0, 0, 0)};
}

SceneObject objectData(const Instance& instance, const SceneMaterial& material, bool mirrored) {
  SceneObject data{};
  data.world_from_local = instance.world_from_local;
  data.normal_from_local = glm::mat4(glm::transpose(glm::inverse(glm::mat3(instance.world_from_local))));
  data.base_color_metallic = glm::vec4(glm::vec3(material.base_color), material.metallic);
  data.emissive_roughness = glm::vec4(material.emissive, material.roughness);
  data.flags = {material.double_sided ? SCENE_DOUBLE_SIDED : 0, 0, mirrored ? -1 : 1, 0};
  return data;
}

template <class T>
std::span<const std::byte> bytesOf(const T& value) {
  return std::as_bytes(std::span(&value, 1));
}

GlBuffer makeUniforms(size_t bytes, const char* label) { return makeBuffer(bytes, {}, GL_DYNAMIC_STORAGE_BIT, label); }

}  // namespace

struct FrameRenderer::Impl {
  const Device* device = nullptr;
  ShaderLibrary* shaders = nullptr;
  MaterialSystem* materials = nullptr;

  std::vector<GpuMesh> meshes;
  std::vector<Object> objects;
  std::vector<std::string> material_names;  // parallel to `loaded`
  std::vector<MaterialId> loaded;
  std::vector<Light> lights;  // without the sun
  std::optional<Light> sun;
  Bounds bounds;
  SunView sun_view;
  ShadowMap shadow;
  bool shadow_drawn = false;
  MultisampleTarget multisample;

  size_t object_stride = 0;
  GlBuffer frame_uniforms, shadow_uniforms, object_uniforms;

  View view;
  FrameSettings settings;
  std::vector<Drawable> visible;
  std::vector<MaterialId> demanded;  // parallel to stats.demands
  FrameStats stats;

  Status loadAssets(const Scene& scene);
  void addObjects(const Scene& scene);
  void addLights(const Scene& scene);
  void makeUniformBuffers();

  void findVisible();
  void demandMaterials();

  SceneFrame frameData() const;
  void uploadUniforms();
  int lightsOf(const Object& object, SceneObject& data) const;
  void bindObject(int object) const;
  void drawObject(int object) const;
  Status drawShadowMap();
  Status drawDepth();
  Status drawShaded();
  Status drawView(const FrameTarget& target);
};

Status FrameRenderer::Impl::loadAssets(const Scene& scene) {
  for (const SceneAsset& asset : scene.assets) {
    auto id = asset.path.empty() ? materials->load(std::shared_ptr(memorySource(asset.embedded, asset.name)), asset.name)
                                 : materials->load(asset.path);
    if (!id) return id.issue();
    loaded.push_back(*id);
    material_names.push_back(asset.path.empty() ? asset.name : asset.path.stem().string());
  }
  return {};
}

void FrameRenderer::Impl::addObjects(const Scene& scene) {
  std::vector<FlatBtfBinding> bindings(scene.meshes.size());
  for (const Instance& instance : scene.instances) {
    Object object;
    object.mesh = instance.mesh;
    if (instance.material >= 0) object.surface = scene.materials[instance.material];
    object.mirrored = glm::determinant(glm::mat3(instance.world_from_local)) < 0;
    object.bounds = transformed(scene.meshes[instance.mesh].bounds, instance.world_from_local);
    object.data = objectData(instance, object.surface, object.mirrored);
    if (const auto& binding = object.surface.flat_btf) {
      object.material = loaded[binding->asset];
      object.periods_per_metre = uvDensity(scene.meshes[instance.mesh], *binding, instance.world_from_local);
      bindings[instance.mesh] = *binding;
    }
    bounds = objects.empty() ? object.bounds
                             : Bounds{glm::min(bounds.min, object.bounds.min), glm::max(bounds.max, object.bounds.max)};
    objects.push_back(std::move(object));
  }
  for (size_t i = 0; i < scene.meshes.size(); ++i) meshes.push_back(uploadMesh(scene.meshes[i], bindings[i]));
}

void FrameRenderer::Impl::addLights(const Scene& scene) {
  for (const Light& light : scene.lights) {
    if (light.kind != LightKind::kSun) lights.push_back(light);
    else if (!sun) sun = light;
  }
  if (lights.size() > SCENE_MAX_LIGHTS) {
    device->log({issue_id::kGltfNode, Severity::kWarning, scene.name,
                 "more than " + std::to_string(SCENE_MAX_LIGHTS) + " lights: the rest is left out"});
    lights.resize(SCENE_MAX_LIGHTS);
  }
  if (!sun) return;
  sun_view = sunView(bounds, sun->direction, ShadowMap::kSide);
  shadow = makeShadowMap();
}

void FrameRenderer::Impl::makeUniformBuffers() {
  GLint alignment = 256;
  glGetIntegerv(GL_UNIFORM_BUFFER_OFFSET_ALIGNMENT, &alignment);
  object_stride = (sizeof(SceneObject) + alignment - 1) / alignment * alignment;
  frame_uniforms = makeUniforms(sizeof(SceneFrame), "frame uniforms");
  shadow_uniforms = makeUniforms(sizeof(SceneFrame), "shadow uniforms");
  object_uniforms = makeUniforms(std::max<size_t>(objects.size(), 1) * object_stride, "object uniforms");
}

// Front to back, by the nearest point of the bounds.
void FrameRenderer::Impl::findVisible() {
  const Frustum frustum = frustumOf(view.clip_from_world);
  visible.clear();
  for (size_t i = 0; i < objects.size(); ++i) {
    const Bounds& box = objects[i].bounds;
    if (!intersects(frustum, box)) continue;
    visible.push_back({static_cast<int>(i), glm::distance(view.position, glm::clamp(view.position, box.min, box.max))});
  }
  std::stable_sort(visible.begin(), visible.end(),
                   [](const Drawable& a, const Drawable& b) { return a.distance < b.distance; });
}

void FrameRenderer::Impl::demandMaterials() {
  demanded.clear();
  if (settings.base_materials_only) return;
  std::vector<std::optional<float>> asked(loaded.size());
  for (const Drawable& drawable : visible) {
    const Object& object = objects[drawable.object];
    if (!object.material) continue;
    const float lambda = settings.lambda.value_or(demandLambda(view, object.bounds, object.periods_per_metre,
                                                               materials->material(object.material).side));
    std::optional<float>& least = asked[object.surface.flat_btf->asset];
    least = std::min(least.value_or(lambda), lambda);
  }
  for (size_t i = 0; i < asked.size(); ++i) {
    if (!asked[i]) continue;
    materials->demand(loaded[i], *asked[i]);
    demanded.push_back(loaded[i]);
    stats.demands.push_back({material_names[i], *asked[i], 0});
  }
}

SceneFrame FrameRenderer::Impl::frameData() const {
  SceneFrame data{};
  data.clip_from_world = view.clip_from_world;
  data.shadow_from_world = sun_view.texture_from_world;
  data.camera_exposure = glm::vec4(view.position, settings.exposure);
  if (sun) {
    data.sun_direction = glm::vec4(-sun->direction, sun_view.texel);
    data.sun_irradiance = glm::vec4(sun->intensity, 0);
  }
  data.sky_ambient = glm::vec4(settings.sky_ambient, 0);
  data.ground_ambient = glm::vec4(settings.ground_ambient, 0);
  data.flags.x = (sun ? SCENE_SUN : 0) | (sun && settings.shadows ? SCENE_SHADOWS : 0) |
                 (settings.tone == ToneCurve::kFilmic ? SCENE_FILMIC : 0) |
                 (settings.lambda ? SCENE_LAMBDA_OVERRIDE : 0);
  data.flags.y = static_cast<int>(lights.size());
  data.lambda = glm::vec4(settings.lambda.value_or(0), 0, 0, 0);
  std::transform(lights.begin(), lights.end(), data.lights, lightData);
  return data;
}

// The lights that reach an object: those that may be strongest at its bounds come first. Returns their number.
int FrameRenderer::Impl::lightsOf(const Object& object, SceneObject& data) const {
  std::vector<std::pair<float, int>> near;
  for (size_t i = 0; i < lights.size(); ++i) {
    if (!reaches(lights[i], object.bounds)) continue;
    const glm::vec3 nearest = glm::clamp(lights[i].position, object.bounds.min, object.bounds.max);
    const float distance = std::max(glm::distance(nearest, lights[i].position), 0.1f);
    const glm::vec3& c = lights[i].intensity;
    near.emplace_back(-(c.x + c.y + c.z) / (distance * distance), static_cast<int>(i));
  }
  std::sort(near.begin(), near.end());
  const int count = std::min<int>(static_cast<int>(near.size()), SCENE_MAX_OBJECT_LIGHTS);
  for (int k = 0; k < count; ++k) data.lights[k / 4][k % 4] = near[k].second;
  return count;
}

// All objects, because the shadow map draws those out of sight too.
void FrameRenderer::Impl::uploadUniforms() {
  SceneFrame frame = frameData();
  glNamedBufferSubData(frame_uniforms.name(), 0, sizeof frame, &frame);
  frame.clip_from_world = sun_view.clip_from_world;
  glNamedBufferSubData(shadow_uniforms.name(), 0, sizeof frame, &frame);
  std::vector<std::byte> all(objects.size() * object_stride);
  for (size_t i = 0; i < objects.size(); ++i) {
    SceneObject data = objects[i].data;
    data.flags.y = lightsOf(objects[i], data);
    std::memcpy(all.data() + i * object_stride, &data, sizeof data);
  }
  if (!all.empty()) glNamedBufferSubData(object_uniforms.name(), 0, GLsizeiptr(all.size()), all.data());
}

void FrameRenderer::Impl::bindObject(int index) const {
  const Object& object = objects[index];
  glBindBufferRange(GL_UNIFORM_BUFFER, SCENE_BLOCK_OBJECT, object_uniforms.name(), GLintptr(index * object_stride),
                    sizeof(SceneObject));
  glFrontFace(object.mirrored ? GL_CW : GL_CCW);
  if (object.surface.double_sided) glDisable(GL_CULL_FACE);
  else glEnable(GL_CULL_FACE);
}

void FrameRenderer::Impl::drawObject(int index) const {
  const GpuMesh& mesh = meshes[objects[index].mesh];
  glBindVertexArray(mesh.array.name());
  glDrawElements(GL_TRIANGLES, mesh.index_count, GL_UNSIGNED_INT, nullptr);
}

// Drawn once: neither sun nor objects move.
Status FrameRenderer::Impl::drawShadowMap() {
  if (!sun || !settings.shadows || shadow_drawn) return {};
  const GlDebugGroup group("sun shadow");
  const Result<uint32_t> program = shaders->program("scene_depth", {});
  if (!program) return program.issue();
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, shadow.framebuffer.name());
  glViewport(0, 0, ShadowMap::kSide, ShadowMap::kSide);
  glClear(GL_DEPTH_BUFFER_BIT);
  glUseProgram(*program);
  glBindBufferBase(GL_UNIFORM_BUFFER, SCENE_BLOCK_FRAME, shadow_uniforms.name());
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(2.0f, 2.0f);
  for (size_t i = 0; i < objects.size(); ++i) {
    bindObject(static_cast<int>(i));
    glDisable(GL_CULL_FACE);
    drawObject(static_cast<int>(i));
    ++stats.depth_draw_calls;
  }
  glDisable(GL_POLYGON_OFFSET_FILL);
  shadow_drawn = true;
  return {};
}

Status FrameRenderer::Impl::drawDepth() {
  if (!settings.depth_prepass) return {};
  const GlDebugGroup group("depth pre-pass");
  const Result<uint32_t> program = shaders->program("scene_depth", {});
  if (!program) return program.issue();
  glUseProgram(*program);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  for (const Drawable& drawable : visible) {
    bindObject(drawable.object);
    drawObject(drawable.object);
    ++stats.depth_draw_calls;
  }
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  return {};
}

// By program and material, front to back within each.
Status FrameRenderer::Impl::drawShaded() {
  const GlDebugGroup group("shading");
  std::vector<Drawable> order = visible;
  const auto material = [&](const Drawable& d) {
    return settings.base_materials_only ? MaterialId{} : objects[d.object].material;
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](const Drawable& a, const Drawable& b) { return material(a).value < material(b).value; });
  glDepthFunc(GL_LEQUAL);
  uint32_t current_program = 0;
  std::optional<uint32_t> current_material;
  for (const Drawable& drawable : order) {
    const MaterialId id = material(drawable);
    if (current_material != id.value) {
      const Result<uint32_t> program = shaders->program("scene_forward", id ? materials->variant(id) : MaterialVariant{});
      if (!program) return program.issue();
      if (current_program != *program) ++stats.program_changes;
      current_program = *program;
      current_material = id.value;
      glUseProgram(current_program);
      if (id) materials->bind(id);
    }
    bindObject(drawable.object);
    drawObject(drawable.object);
    ++stats.draw_calls;
    stats.triangles += uint64_t(meshes[objects[drawable.object].mesh].index_count) / 3;
  }
  return {};
}

Status FrameRenderer::Impl::drawView(const FrameTarget& target) {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, target.framebuffer);
  glViewport(0, 0, target.size.x, target.size.y);
  glEnable(GL_FRAMEBUFFER_SRGB);
  glClearColor(settings.background.r, settings.background.g, settings.background.b, 1);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glBindBufferBase(GL_UNIFORM_BUFFER, SCENE_BLOCK_FRAME, frame_uniforms.name());
  if (sun) glBindTextureUnit(SCENE_UNIT_SHADOW, shadow.depth.name());
  if (Status status = drawDepth(); !status) return status;
  return drawShaded();
}

FrameRenderer::FrameRenderer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FrameRenderer::~FrameRenderer() = default;

Result<std::unique_ptr<FrameRenderer>> FrameRenderer::create(const Device& device, ShaderLibrary& shaders,
                                                             MaterialSystem& materials, const Scene& scene) {
  auto impl = std::make_unique<Impl>();
  impl->device = &device;
  impl->shaders = &shaders;
  impl->materials = &materials;
  const GlDrawStateScope scope(0, 0);
  if (Status assets = impl->loadAssets(scene); !assets) return assets.issue();
  impl->addObjects(scene);
  impl->addLights(scene);
  impl->makeUniformBuffers();
  return std::unique_ptr<FrameRenderer>(new FrameRenderer(std::move(impl)));
}

void FrameRenderer::prepare(const View& view, const FrameSettings& settings) {
  impl_->view = view;
  impl_->settings = settings;
  impl_->stats = {};
  impl_->stats.objects = static_cast<int>(impl_->objects.size());
  impl_->findVisible();
  impl_->stats.visible_objects = static_cast<int>(impl_->visible.size());
  impl_->demandMaterials();
}

Status FrameRenderer::draw(const FrameTarget& target) {
  Impl& self = *impl_;
  const GlDrawStateScope scope(kUnits, kUniformBindings);
  self.uploadUniforms();
  glDisable(GL_BLEND);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_STENCIL_TEST);
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LESS);
  glDepthMask(GL_TRUE);
  glClearDepth(1);
  glCullFace(GL_BACK);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  if (Status status = self.drawShadowMap(); !status) return status;

  const bool sampled = self.settings.samples > 1;
  if (sampled && (self.multisample.size != target.size || self.multisample.samples != self.settings.samples))
    self.multisample = makeMultisampleTarget(target.size, self.settings.samples);
  const FrameTarget view = sampled ? FrameTarget{self.multisample.framebuffer.name(), target.size} : target;
  if (Status status = self.drawView(view); !status) return status;
  if (sampled) resolve(self.multisample, target.framebuffer);

  for (size_t i = 0; i < self.demanded.size(); ++i)
    self.stats.demands[i].resident = self.materials->residentLambda(self.demanded[i]);
  return {};
}

void FrameRenderer::finish() const { glFinish(); }

const FrameStats& FrameRenderer::stats() const { return impl_->stats; }
Bounds FrameRenderer::bounds() const { return impl_->bounds; }

}  // namespace loden::runtime
