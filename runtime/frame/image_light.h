// Private to the renderer: the textures of image based lighting.
#pragma once

#include <memory>

#include "runtime/gl/gl_objects.h"
#include "runtime/scene/reflections.h"

namespace loden::runtime {

class ImageLight {
 public:
  ImageLight();
  // Uploads the map unless it is the one shown last; null: there is no map.
  void show(const std::shared_ptr<const ReflectionMap>& map);
  // Binds the reflectance table to SCENE_UNIT_REFLECTANCE, and the map, if there is one, to
  // SCENE_UNIT_REFLECTIONS.
  void bind() const;

 private:
  std::shared_ptr<const ReflectionMap> shown_;
  GlTexture reflections_, reflectance_;
};

}  // namespace loden::runtime
