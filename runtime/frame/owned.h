// Private to the renderer: ownership of what a MaterialSystem has loaded.
#pragma once

#include <utility>

#include "runtime/gl/material/material_system.h"

namespace loden::runtime {

// A material or a texture that is unloaded when this object is destroyed. The system must outlive it, with
// its context current then.
template <class Id>
class Owned {
 public:
  Owned(MaterialSystem& system, Id id) : system_(&system), id_(id) {}
  Owned(Owned&& other) noexcept : system_(std::exchange(other.system_, nullptr)), id_(other.id_) {}
  Owned& operator=(Owned&& other) noexcept {
    std::swap(system_, other.system_);
    std::swap(id_, other.id_);
    return *this;
  }
  ~Owned() {
    if (system_) system_->unload(id_);
  }
  Id id() const { return id_; }

 private:
  MaterialSystem* system_;
  Id id_;
};

using OwnedMaterial = Owned<MaterialId>;
using OwnedTexture = Owned<TextureId>;

}  // namespace loden::runtime
