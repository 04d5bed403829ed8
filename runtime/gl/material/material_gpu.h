// The GPU side of one material: its uniform block, the textures of its resident parts, and what stands in for
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

// Textures that all materials share: one texel of nothing per target, and nearest-direction images.
class SharedTextures {
 public:
  void create();
  void contextLost();
  // One name per unit, for units that hold no part.
  std::vector<uint32_t> emptyUnits(const MaterialVariant& variant) const;
  // The image of nearestDirectionLookup, shared by those that ask for the same set while one of them keeps
  // it.
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

  // Makes block and stand-ins in the current context.
  void create(SharedTextures& shared);
  void contextLost();

  // A part's textures, in the order of its LoadedPart; units are taken from there. Where two parts hold a
  // unit, the later in the list is read.
  void setPart(size_t part, std::vector<GlTexture> textures, const LoadedPart& loaded);
  void dropPart(size_t part);

  // Writes the block, and what stands in for surface maps, if the state differs from what they hold; whether
  // it did.
  bool publish(const ResidentState& state);
  // Binds block and textures; samplers of these units are set to none.
  void bind() const;

 private:
  struct PartTextures {
    std::vector<GlTexture> textures;
    std::vector<int> units;
  };
  // One texel a layer in the place of a surface map. Maps have no window to come in by: the texel turns from
  // the fitted mean into the map's average as they fade in, and then gives way to the map.
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
  std::shared_ptr<const GlTexture> nearest_light_, nearest_view_;  // of tables of layout 0
  bool stand_ins_shown_ = true;
  std::vector<uint32_t> empty_, bound_;  // by unit, of unitsOf(variant_)
};

}  // namespace loden::runtime
