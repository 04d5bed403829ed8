// One material on the GPU: its uniform block, the textures of its resident parts, and small stand-ins for
// those that are absent. Private to the runtime.
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "material/model/material.h"
#include "runtime/gl/gl_objects.h"
#include "runtime/stream/material_data.h"
#include "runtime/stream/material_parts.h"

namespace loden::runtime {

// Textures that all materials share: one empty texel per texture target, and images of the nearest sampled
// direction.
class SharedTextures {
 public:
  void create();
  void contextLost();
  // One GL name per texture unit: the textures to bind to units that hold no part.
  std::vector<uint32_t> emptyUnits(const MaterialVariant& variant) const;
  // The texture of nearestDirectionLookup(set), shared by all that ask for the same set while one of them
  // keeps it.
  std::shared_ptr<const GlTexture> nearestImage(const DirectionSet& set);

 private:
  GlTexture empty_2d_, empty_array_, empty_volume_, empty_index_;
  std::map<std::string, std::weak_ptr<GlTexture>> nearest_;
};

class MaterialGpu {
 public:
  MaterialGpu() = default;
  MaterialGpu(const Material& material, const MaterialVariant& variant, const std::string& label,
              size_t parts);

  // Creates the uniform block and the stand-ins in the current context.
  void create(SharedTextures& shared);
  void contextLost();

  // Sets a part's textures, in the order of LoadedPart::textures, which also gives their units. If two parts
  // hold the same unit, the later one in the list is read.
  void setPart(size_t part, std::vector<GlTexture> textures, const LoadedPart& loaded);
  void dropPart(size_t part);

  // Writes the uniform block and the stand-ins for surface maps if the state differs from what they hold.
  // Returns whether it did.
  bool publish(const ResidentState& state);
  // Binds the uniform block and the textures, and unbinds samplers from these units.
  void bind() const;

 private:
  struct PartTextures {
    std::vector<GlTexture> textures;
    std::vector<int> units;
  };
  // One texel per layer in the place of a surface map. Surface maps have no window by which they could fade
  // in. Therefore the texel turns from the fitted mean into the map's average while they fade in, and then is
  // replaced by the map.
  struct StandIn {
    PartTexture texel;
    std::vector<glm::vec4> mean, average;  // per layer
    GlTexture texture;
  };
  void createSurfaceStandIns();
  void fadeStandIns(float share);
  void chooseUnits();

  const Material* material_ = nullptr;
  MaterialVariant variant_;
  std::string label_;
  LodenMaterialData data_{};
  ResidentState published_;
  bool written_ = false;
  GlBuffer block_;
  std::vector<PartTextures> parts_;
  std::vector<StandIn> stand_ins_;
  std::shared_ptr<const GlTexture> nearest_light_, nearest_view_;  // for tables of TableLayout::kNearest
  bool stand_ins_shown_ = true;
  std::vector<uint32_t> empty_, bound_;  // [unit]: GL names of the textures; unitsOf(variant_) units
};

}  // namespace loden::runtime
