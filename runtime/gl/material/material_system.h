// The material system: opens assets, streams their parts to the GPU and evicts them under a byte budget, and
// binds them for shaders/loden_material.glsl. It streams textures of the engine's own within the same budget.
// The calls of one frame are
//   demand() for each visible material and texture, update(), then bind() before a material's draws.
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
#include "runtime/stream/image_texture.h"
#include "runtime/stream/shader_variants.h"

namespace loden::runtime {

// The name of a loaded material (index and generation); 0 is no material. After unload() it stays invalid
// until its slot has been reused 4096 times.
struct MaterialId {
  uint32_t value = 0;
  explicit operator bool() const { return value != 0; }
  friend bool operator==(MaterialId, MaterialId) = default;
};
// The same for a texture.
struct TextureId {
  uint32_t value = 0;
  explicit operator bool() const { return value != 0; }
  friend bool operator==(TextureId, TextureId) = default;
};

struct MaterialSystemOptions {
  uint64_t budget_bytes = 64u << 20;  // most GPU bytes of all parts, those in flight included
  // Most bytes uploaded per frame, but at least one row of texels.
  uint64_t upload_bytes_per_frame = 256u << 10;
  // Speed at which detail that arrives in view fades in: levels of detail per second.
  float fade_levels_per_second = 4;
  // Most levels of detail that fade in during one frame, however long it takes; above 0.
  float fade_levels_per_frame = 1.0f / 15;
  // Parts that have not been demanded for longer than this are released even if there is room, in seconds.
  float release_seconds = 3;
  // The VDIM look-up of materials that have geometry; kQuality is drawn as kDefault. A material that stores a
  // VDIM uses kPaper.
  Lookup lookup = Lookup::kDefault;
  // How cast shadows of near terms are found. kNone leaves them out. kFast and kDefault use at most that
  // look-up, or the shadow map of assets that are cooked to use it. kMap uses the shadow map where an asset
  // holds one, else kFast.
  Visibility visibility = Visibility::kDefault;
  // The VDIM atlas size of every material; empty: the size that its asset asks for. It is an upper bound: a
  // material for whose atlas the budget has no room is drawn with a small one.
  std::optional<VdimAtlasSize> atlas_size = {};
  int first_unit = 0;     // the first texture unit that materials use; units below are left to the engine
  int atlas_threads = 1;  // threads that build one VDIM atlas, besides the loading thread
};

// Numbers for a report. Bytes are those of the parts of materials and textures, as texel data.
struct MaterialStats {
  int materials = 0, textures = 0;
  int parts_resident = 0, parts_in_flight = 0;
  uint64_t resident_bytes = 0;  // GPU memory, parts in flight included
  uint64_t texture_bytes = 0;   // of resident_bytes, those of textures
  uint64_t peak_bytes = 0;      // largest resident_bytes of any frame
  uint64_t total_bytes = 0;     // what all parts of all materials and textures would take
  uint64_t read_bytes = 0;      // read from files since the start
  uint64_t uploaded_bytes = 0;  // uploaded since the start
  uint64_t uploaded_last_frame = 0;
  uint64_t evicted_parts = 0;
  // Parts that could not be read, or for which the driver or the process had no memory.
  uint64_t failed_parts = 0;
  uint64_t failed_memory = 0;  // of the failed parts, those for which there was no memory
};

// One streamable part of a material or a texture.
struct PartStats {
  std::string name;    // "band 0", "geometry", "near term", "mips from 2 on" ...
  uint64_t bytes = 0;  // size on the GPU
  bool resident = false;
};

class MaterialSystem {
 public:
  // A material system on the device, which must be current and must outlive the system. Issues: kOption.
  static Result<std::unique_ptr<MaterialSystem>> create(const Device& device,
                                                        const MaterialSystemOptions& options);
  ~MaterialSystem();
  MaterialSystem(const MaterialSystem&) = delete;
  MaterialSystem& operator=(const MaterialSystem&) = delete;

  // Opens an asset and returns its name. Reads only the header, on the calling thread, and creates the
  // material's small GL objects; the parts follow on demand, read by the loading threads. Issues: those of
  // AssetFile::open; kLimit if the shaders or the driver take no material of this size; kMemory (which every
  // call that returns an issue may return). After an issue all other materials are as they were.
  Result<MaterialId> load(std::shared_ptr<const ByteSource> source, const std::string& name);
  Result<MaterialId> load(const std::filesystem::path& path);
  void unload(MaterialId id);
  // Takes a texture, which is then streamed like a material: mip by mip, as demand() asks. Issues:
  // kGlContext, kMemory. After an issue everything is as it was.
  Result<TextureId> loadTexture(const ImageTexture& image);
  void unload(TextureId id);
  // Sets budget_bytes from the next update() on, which evicts what no longer fits.
  void setBudget(uint64_t bytes);

  // The variant that the material's shader must be compiled for; it never changes while the material is
  // loaded.
  MaterialVariant variant(MaterialId id) const;
  // The material's description, without texel data.
  const Material& material(MaterialId id) const;

  // Says that a visible surface needs this material at `lambda` or coarser in this frame; of several calls
  // the smallest lambda counts. May throw std::bad_alloc, and then has no effect.
  void demand(MaterialId id, float lambda);
  // The same for a texture: `lambda` is the finest of the image's mips that a pixel reads.
  void demand(TextureId id, float lambda);
  // Does the work of one frame, without waiting: takes what the loading threads delivered, uploads within the
  // bound, evicts, advances fades, and requests more. Call it once per frame; `seconds` is the time since the
  // last call. A part for which there is no memory becomes a failed part.
  void update(float seconds);
  // Calls update() until every demanded part is resident, or cannot be, and shows it without a fade; for
  // captures and tests. May throw std::bad_alloc; the next call continues.
  void finishLoading();

  // Binds the material's uniform block to LODEN_BLOCK_MATERIAL (shaders/loden_shared.h), and its textures to
  // unitsOf(variant(id)) texture units from MaterialSystemOptions::first_unit on. This is the only call that
  // leaves GL state changed.
  void bind(MaterialId id);
  // The GL name of a GL_TEXTURE_2D that shows the resident mips of the texture; it sets the sampling too, so
  // that no sampler must be bound. Valid until the next call of update(), finishLoading() or unload().
  uint32_t textureName(TextureId id) const;
  // The smallest lambda that the shader will use; finer detail is not resident.
  float residentLambda(MaterialId id) const;
  float residentLambda(TextureId id) const;

  // A number that changes whenever what a material with relief shows changes, which is when parts arrive, are
  // evicted or fade. A depth map drawn with its relief is out of date then.
  uint64_t reliefRevision() const;

  // Call contextLost() after the GL context is gone; it forgets every GL name. Call contextRestored() when
  // the new context is current; everything is then streamed in again. In between no call touches GL: load()
  // returns kGlContext, update() and finishLoading() do nothing, and bind() must not be called. If
  // contextRestored() returns an issue, it may be called again.
  void contextLost();
  Status contextRestored();

  const MaterialStats& stats() const;
  // The parts in the order in which they are loaded.
  std::vector<PartStats> parts(MaterialId id) const;
  std::vector<PartStats> parts(TextureId id) const;

 private:
  struct Impl;
  explicit MaterialSystem(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace loden::runtime
