// One image's texture on the GPU: the textures of its resident parts, of which the finest is shown, and a
// single texel that is shown while there is none. Private to the runtime.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/gl/gl_objects.h"
#include "runtime/stream/image_parts.h"

namespace loden::runtime {

// Whether minification reads mips.
bool isMipmapped(const ImageTexture& image);

class TextureGpu {
 public:
  TextureGpu(ImageTexture image, size_t parts) : image_(std::move(image)), parts_(parts) {}

  // Creates the single texel, which is the image's coarsest mip, in the current context.
  void create();
  void contextLost();

  const ImageTexture& image() const { return image_; }
  // Sets the texture of a part, which has texels already.
  void setPart(size_t part, GlTexture texture, const PartTexture& source);
  void dropPart(size_t part) { parts_[part] = {}; }

  // Chooses the texture to show, and keeps it from showing mips of the image below `lambda`. Returns whether
  // anything changed.
  bool publish(float lambda);
  // The GL name of the texture to bind.
  uint32_t name() const { return shown_; }

 private:
  struct Part {
    GlTexture texture;
    int first_mip = 0;
    bool mipmapped = false;
  };
  void setSampling(uint32_t texture) const;

  ImageTexture image_;
  GlTexture texel_;
  std::vector<Part> parts_;  // coarsest first
  uint32_t shown_ = 0;
  float shown_lambda_ = 0;
};

}  // namespace loden::runtime
