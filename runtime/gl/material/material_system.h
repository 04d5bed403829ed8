// Materials on the GPU: opens assets, streams their parts in and out under a byte budget, and binds them for
// shaders/loden_material.glsl. One call sequence per frame:
//   demand() for each visible material, update(), then bind() before its draws.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "material/asset/asset.h"
#include "material/base/result.h"
#include "material/eval/evaluate.h"
#include "runtime/gl/device.h"
#include "runtime/stream/shader_variants.h"

namespace loden::runtime {

// Index and generation: stays invalid after unload, until a slot has been used 4096 times. 0 is no material.
struct MaterialId {
  uint32_t value = 0;
  explicit operator bool() const { return value != 0; }
  friend bool operator==(MaterialId, MaterialId) = default;
};

struct MaterialSystemOptions {
  uint64_t budget_bytes = 64u << 20;             // GPU bytes of all parts, those in flight included
  uint64_t upload_bytes_per_frame = 256u << 10;  // at least one row of texels goes up per frame
  float fade_levels_per_second = 4;              // of detail that arrives in view
  float fade_levels_per_frame = 1.0f / 15;       // at most, however long a frame takes; above 0
  float release_seconds = 3;         // what nobody has demanded for longer goes even where there is room
  Lookup lookup = Lookup::kDefault;  // where a material has geometry; kPaper where it stores a VDIM; kQuality
                                     // is drawn as kDefault
  // Of near terms that have cast shadows: kNone leaves them out; kFast and kDefault, at most that lookup, or
  // the shadow map of assets that are cooked for it; kMap, the shadow map where an asset holds one, else
  // kFast.
  Visibility visibility = Visibility::kDefault;
  // Of every material; empty: what its asset asks for. At most: what the budget has no room for is drawn with
  // a small one.
  std::optional<VdimAtlasSize> atlas_size = {};
  int first_unit = 0;     // texture unit that a material's begin at; what lies below stays the engine's
  int atlas_threads = 1;  // that build one VDIM atlas, beside the loading thread
};

// What a report counts. Bytes are of the asset parts, as texel data.
struct MaterialStats {
  int materials = 0;
  int parts_resident = 0, parts_in_flight = 0;
  uint64_t resident_bytes = 0;  // of GPU memory, in flight included
  uint64_t peak_bytes = 0;      // largest resident_bytes of any frame
  uint64_t total_bytes = 0;     // if everything of every material were resident
  uint64_t read_bytes = 0;      // from files, since the start
  uint64_t uploaded_bytes = 0;  // since the start
  uint64_t uploaded_last_frame = 0;
  uint64_t evicted_parts = 0;
  uint64_t failed_parts = 0;   // could not be read, or had no room in the driver's or the process's memory
  uint64_t failed_memory = 0;  // of these the latter
};

// One streamable part of a material.
struct PartStats {
  std::string name;    // "band 0", "geometry", "near term" ...
  uint64_t bytes = 0;  // on the GPU
  bool resident = false;
};

class MaterialSystem {
 public:
  // The device must be current and outlive the system. Issues: kOption.
  static Result<std::unique_ptr<MaterialSystem>> create(const Device& device,
                                                        const MaterialSystemOptions& options);
  ~MaterialSystem();
  MaterialSystem(const MaterialSystem&) = delete;
  MaterialSystem& operator=(const MaterialSystem&) = delete;

  // Reads the header only, on this thread, and makes the material's small GL objects; parts follow on demand,
  // read from the loading threads. Issues of AssetFile::open; kLimit if the shaders or the driver take no
  // material of this size; kMemory, as of all calls that return an issue. Others are as they were then.
  Result<MaterialId> load(std::shared_ptr<const ByteSource> source, const std::string& name);
  Result<MaterialId> load(const std::filesystem::path& path);
  void unload(MaterialId id);
  // From the next update() on; what no longer fits is evicted there.
  void setBudget(uint64_t bytes);

  // What the material's program must be built for; fixed for its life.
  MaterialVariant variant(MaterialId id) const;
  // Description without texel data.
  const Material& material(MaterialId id) const;

  // Some visible surface asks for this material at `lambda` or coarser this frame; the smallest counts. May
  // throw std::bad_alloc, and nothing is asked for then.
  void demand(MaterialId id, float lambda);
  // Once per frame: takes what the loading thread delivered, uploads within the bound, evicts, fades in, asks
  // for more. Never waits. Seconds since the last call. A part that finds no memory is a failed part.
  void update(float seconds);
  // Updates until every demanded part is resident, or cannot be, and shows it without a fade; for captures
  // and tests. May throw std::bad_alloc, and goes on with the next call.
  void finishLoading();

  // Binds the material's uniform block and textures (shaders/loden_shared.h: LODEN_BLOCK_MATERIAL, and
  // unitsOf(variant(id)) texture units from MaterialSystemOptions::first_unit on). The one call that leaves
  // GL state behind.
  void bind(MaterialId id);
  // The smallest lambda that the shader will use: detail below it is not resident.
  float residentLambda(MaterialId id) const;

  // Changes whenever what a material with relief shows changes: parts that come or go, and their fades. Depth
  // that was drawn with its relief is out of date then.
  uint64_t reliefRevision() const;

  // After the context is gone: forget every name; after the new one is current: everything streams in again.
  // In between no call touches GL: load() refuses (kGlContext), update() and finishLoading() do nothing, and
  // bind() is a mistake. Where contextRestored() gives an issue, it may be called again.
  void contextLost();
  Status contextRestored();

  const MaterialStats& stats() const;
  // In the order in which they arrive.
  std::vector<PartStats> parts(MaterialId id) const;

 private:
  struct Impl;
  explicit MaterialSystem(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace loden::runtime
