// Private to the renderer: image based lighting's textures.
#pragma once

#include <memory>

#include "runtime/gl/gl_objects.h"
#include "runtime/scene/reflections.h"

namespace loden::runtime {

class ImageLight {
 public:
  ImageLight();
  // Uploads the map unless it is the one that was shown last; null: none.
  void show(const std::shared_ptr<const ReflectionMap>& map);
  // Binds SCENE_UNIT_REFLECTANCE, and SCENE_UNIT_REFLECTIONS if there are any.
  void bind() const;

 private:
  std::shared_ptr<const ReflectionMap> shown_;
  GlTexture reflections_, reflectance_;
};

}  // namespace loden::runtime
