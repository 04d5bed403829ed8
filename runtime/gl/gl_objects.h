// Owners of GL object names: move-only, empty after a move, labelled for debuggers. The context of the
// object's device must be current when it is created, used and destroyed. GL enumerants are passed as
// uint32_t, so that no header needs GL's.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

namespace loden::runtime {

enum class GlKind { kTexture, kBuffer, kFramebuffer, kProgram, kVertexArray };

namespace detail {
void deleteGlName(GlKind kind, uint32_t name);
}

template <GlKind kKind>
class GlObject {
 public:
  GlObject() = default;
  explicit GlObject(uint32_t name) : name_(name) {}  // takes ownership
  GlObject(GlObject&& other) noexcept : name_(other.release()) {}
  GlObject& operator=(GlObject&& other) noexcept {
    if (this != &other) {
      reset();
      name_ = other.release();
    }
    return *this;
  }
  ~GlObject() { reset(); }

  uint32_t name() const { return name_; }
  explicit operator bool() const { return name_ != 0; }
  void reset() {
    if (name_ != 0) detail::deleteGlName(kKind, release());
  }
  // Returns the name and forgets it without deleting it: for a context that is gone.
  uint32_t release() { return std::exchange(name_, 0); }

 private:
  uint32_t name_ = 0;
};

using GlTexture = GlObject<GlKind::kTexture>;
using GlBuffer = GlObject<GlKind::kBuffer>;
using GlFramebuffer = GlObject<GlKind::kFramebuffer>;
using GlProgram = GlObject<GlKind::kProgram>;
using GlVertexArray = GlObject<GlKind::kVertexArray>;

// Sets the label that debuggers show for the object (KHR_debug).
void setGlLabel(GlKind kind, uint32_t name, std::string_view label);

// A texture without storage; `target` as in glCreateTextures.
GlTexture makeTexture(uint32_t target, std::string_view label);
// A buffer with immutable storage; `flags` as in glNamedBufferStorage. `data` must hold the whole buffer, or
// be empty.
GlBuffer makeBuffer(size_t bytes, std::span<const std::byte> data, uint32_t flags, std::string_view label);
GlFramebuffer makeFramebuffer(std::string_view label);
GlVertexArray makeVertexArray(std::string_view label);

// A named group in debuggers' call lists, for the lifetime of this object; one per pass.
class GlDebugGroup {
 public:
  explicit GlDebugGroup(std::string_view name);
  ~GlDebugGroup();
  GlDebugGroup(const GlDebugGroup&) = delete;
  GlDebugGroup& operator=(const GlDebugGroup&) = delete;
};

}  // namespace loden::runtime
