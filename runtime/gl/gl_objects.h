// Owners of GL names: move-only, empty when moved from, labelled. Creation, use and destruction need the
// context of the object's device current. GL enumerants travel as uint32_t, so that no header needs GL's.
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
  // Forgets the name without deleting it: for a context that is gone.
  uint32_t release() { return std::exchange(name_, 0); }

 private:
  uint32_t name_ = 0;
};

using GlTexture = GlObject<GlKind::kTexture>;
using GlBuffer = GlObject<GlKind::kBuffer>;
using GlFramebuffer = GlObject<GlKind::kFramebuffer>;
using GlProgram = GlObject<GlKind::kProgram>;
using GlVertexArray = GlObject<GlKind::kVertexArray>;

// What debuggers show for the object (KHR_debug).
void setGlLabel(GlKind kind, uint32_t name, std::string_view label);

// A texture without storage; target as in glCreateTextures.
GlTexture makeTexture(uint32_t target, std::string_view label);
// Immutable storage; flags as in glNamedBufferStorage. Data must hold the whole buffer, or be empty.
GlBuffer makeBuffer(size_t bytes, std::span<const std::byte> data, uint32_t flags, std::string_view label);
GlFramebuffer makeFramebuffer(std::string_view label);
GlVertexArray makeVertexArray(std::string_view label);

// A named group in debuggers' call lists, for one pass.
class GlDebugGroup {
 public:
  explicit GlDebugGroup(std::string_view name);
  ~GlDebugGroup();
  GlDebugGroup(const GlDebugGroup&) = delete;
  GlDebugGroup& operator=(const GlDebugGroup&) = delete;
};

}  // namespace loden::runtime
