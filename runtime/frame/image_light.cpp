#include "runtime/frame/image_light.h"

#include <epoxy/gl.h>

#include "runtime/gl/gl_state.h"
#include "shaders/scene_shared.h"

namespace loden::runtime {
namespace {

constexpr int kTableSide = 32;

void setLinear(GLuint texture, GLint min_filter) {
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, min_filter);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

}  // namespace

ImageLight::ImageLight() : reflectance_(makeTexture(GL_TEXTURE_2D, "reflectance")) {
  const GlPixelStateScope pixels;
  static const std::vector<glm::vec4> table = makeReflectanceTable(kTableSide);
  const GLuint name = reflectance_.name();
  glTextureStorage2D(name, 1, GL_RGBA16F, kTableSide, kTableSide);
  glTextureSubImage2D(name, 0, 0, 0, kTableSide, kTableSide, GL_RGBA, GL_FLOAT, table.data());
  setLinear(name, GL_LINEAR);
}

void ImageLight::show(const std::shared_ptr<const ReflectionMap>& map) {
  if (map == shown_) return;
  shown_ = map;
  reflections_.reset();
  if (!map) return;
  const GlPixelStateScope pixels;
  reflections_ = makeTexture(GL_TEXTURE_CUBE_MAP, "reflections");
  const GLuint name = reflections_.name();
  glTextureStorage2D(name, ReflectionMap::kLevels + 1, GL_RGBA16F, ReflectionMap::kSide,
                     ReflectionMap::kSide);
  for (int level = 0; level <= ReflectionMap::kLevels; ++level) {
    const int side = ReflectionMap::kSide >> level;
    glTextureSubImage3D(name, level, 0, 0, 0, side, side, 6, GL_RGB, GL_FLOAT,
                        map->levels[size_t(level)].data());
  }
  setLinear(name, GL_LINEAR_MIPMAP_LINEAR);
}

void ImageLight::bind() const {
  glBindTextureUnit(SCENE_UNIT_REFLECTANCE, reflectance_.name());
  glBindSampler(SCENE_UNIT_REFLECTANCE, 0);
  if (!reflections_) return;
  glBindTextureUnit(SCENE_UNIT_REFLECTIONS, reflections_.name());
  glBindSampler(SCENE_UNIT_REFLECTIONS, 0);
}

}  // namespace loden::runtime
