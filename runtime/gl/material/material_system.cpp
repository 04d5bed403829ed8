#include "runtime/gl/material/material_system.h"

#include <algorithm>
#include <atomic>
#include <deque>
#include <utility>
#include <vector>

#include "material/base/check.h"
#include "material/base/issues.h"
#include "material/base/memory_issue.h"
#include "material/system/asset_io.h"
#include "runtime/gl/gl_state.h"
#include "runtime/gl/material/gl_texture.h"
#include "runtime/gl/material/material_gpu.h"
#include "runtime/gl/material/texture_gpu.h"
#include "runtime/stream/residency.h"
#include "runtime/stream/streaming.h"

namespace loden::runtime {
namespace {

constexpr uint32_t kIndexBits = 20;
constexpr uint32_t kMaxMaterials = (1u << kIndexBits) - 2;

// A part on its way to the GPU.
struct UploadJob {
  PartTicket ticket;
  LoadedPart part;
  std::vector<GlTexture> textures;  // allocated one by one
  TextureUpload upload;             // of textures.back()
};

// A material, or a texture.
struct Slot {
  bool alive = false;
  uint32_t generation = 0;
  std::string name;
  std::vector<PartPlan> plan;
  std::vector<uint64_t>
      serials;  // per part: of the request that counts; 0: none, or it is not there any more
  std::optional<TextureGpu> texture;
  // Of a material only.
  std::shared_ptr<const AssetFile> file;
  MaterialVariant variant;
  std::vector<std::shared_ptr<const Material>> leads;  // per part: LoadedPart::lead
  MaterialGpu gpu;
};

struct Demand {
  uint32_t slot;
  float lambda;
};

std::string partName(const PartPlan& part) {
  if (part.mips > 0) return "mips from " + std::to_string(part.first_mip) + " on";
  const bool lead = part.share == Share::kLead;
  switch (part.kind) {
    case PartKind::kBand:
      return "band " + std::to_string(part.band) + (lead ? ", first" : "");
    case PartKind::kGeometry:
      return part.desc.refines ? "indirection" : "geometry";
    case PartKind::kStoredVdim:
      return "stored indirection";
    case PartKind::kSurface:
      return lead ? "near term, coarse" : "near term";
  }
  return {};
}

Status checkOptions(const MaterialSystemOptions& options) {
  const auto issue = [](const char* text) {
    return Issue{issue_id::kOption, Severity::kError, "material system", text};
  };
  if (!(options.fade_levels_per_second > 0)) return issue("fade_levels_per_second must be above 0");
  if (!(options.fade_levels_per_frame > 0)) return issue("fade_levels_per_frame must be above 0");
  if (!(options.release_seconds > 0)) return issue("release_seconds must be above 0");
  constexpr int kTexels = AssetLimits::kMaxAtlasTexels, kDirections = AssetLimits::kMaxAtlasDirections;
  if (const auto& size = options.atlas_size;
      size &&
      (size->texels < 1 || size->directions < 1 || size->texels > kTexels || size->directions > kDirections))
    return issue("atlas_size must be 1 to 128 texels and 1 to 45 directions");
  if (options.first_unit < 0 || options.first_unit > 255) return issue("first_unit must be 0 to 255");
  return {};
}

// Where the material's textures go.
Status placeUnits(MaterialVariant& variant, const MaterialSystemOptions& options,
                  const Capabilities& capabilities, const std::string& name) {
  variant.first_unit = static_cast<uint8_t>(options.first_unit);
  const int needed = options.first_unit + unitsOf(variant);
  if (needed <= capabilities.max_fragment_textures) return {};
  return Issue{issue_id::kLimit, Severity::kError, name,
               "needs texture units up to " + std::to_string(needed) + ", and the driver has " +
                   std::to_string(capabilities.max_fragment_textures)};
}

}  // namespace

struct MaterialSystem::Impl {
  Impl(const Device& d, const MaterialSystemOptions& o)
      : device(&d), options(o), residency(residencyOptions(o)) {}

  static ResidencyOptions residencyOptions(const MaterialSystemOptions& options) {
    ResidencyOptions r;
    r.budget_bytes = options.budget_bytes;
    r.fade_levels_per_second = options.fade_levels_per_second;
    r.fade_levels_per_frame = options.fade_levels_per_frame;
    r.release_seconds = options.release_seconds;
    return r;
  }

  const Slot& slotNamed(uint32_t name) const {
    LODEN_CHECK(name != 0);
    const uint32_t index = (name & ((1u << kIndexBits) - 1)) - 1;
    LODEN_CHECK_LT(index, slots.size());
    LODEN_CHECK(slots[index].alive);
    LODEN_CHECK_EQ(slots[index].generation & 0xfffu, name >> kIndexBits);
    return slots[index];
  }
  const Slot& slotOf(MaterialId id) const {
    const Slot& slot = slotNamed(id.value);
    LODEN_CHECK(!slot.texture);
    return slot;
  }
  const Slot& slotOf(TextureId id) const {
    const Slot& slot = slotNamed(id.value);
    LODEN_CHECK(slot.texture);
    return slot;
  }
  template <class Id>
  uint32_t indexOf(Id id) const {
    return static_cast<uint32_t>(&slotOf(id) - slots.data());
  }

  void takeDeliveries();
  void pumpUploads();
  enum class Pumped { kUnderWay, kComplete, kNoMemory };
  Pumped pumpJob(UploadJob& job, int64_t& budget);
  bool allocateNext(UploadJob& job);
  void fail(PartRef ref, const Issue& issue) noexcept;
  void failForMemory(PartRef ref) noexcept;
  Result<MaterialId> load(std::shared_ptr<const ByteSource> source, const std::string& name);
  Result<TextureId> loadTexture(const ImageTexture& image);
  uint32_t addSlot(Slot made, std::vector<PartDesc> descs);
  void unload(uint32_t index);
  void demand(uint32_t index, float lambda);
  std::vector<PartStats> partsOf(uint32_t index) const;
  void create(Slot& slot);
  void noLongerThere(PartRef ref) noexcept;
  void finishJob(UploadJob& job);
  void evict(PartRef ref);
  void request(PartRef ref);
  void requestMips(PartRef ref);
  void publishActive();
  ResidentState residentState(uint32_t index) const;
  void countFrame();
  void publish(uint32_t index) {
    Slot& slot = slots[index];
    if (slot.texture)
      slot.texture->publish(residency.publishedLambda(index));
    else
      relief_revision += slot.gpu.publish(residentState(index)) && hasRelief(slot.variant);
  }
  bool current(const PartTicket& ticket) const {
    const Slot& slot = slots[ticket.ref.slot];
    return slot.alive && ticket.ref.part < slot.serials.size() &&
           slot.serials[ticket.ref.part] == ticket.serial;
  }

  const Device* device;
  MaterialSystemOptions options;
  Residency residency;
  SharedTextures shared;
  std::vector<Slot> slots;  // index = residency slot
  std::deque<UploadJob> uploads;
  std::vector<Demand> demands, last_demands;
  uint64_t next_serial = 1;
  bool lost = false;  // the context
  uint64_t relief_revision = 0;
  MaterialStats stats;
  std::atomic<uint64_t> read_bytes{0};
  LoadingThreads loader;  // last: its threads end first; they get copies, and share read_bytes
};

Result<std::unique_ptr<MaterialSystem>> MaterialSystem::create(const Device& device,
                                                               const MaterialSystemOptions& options) {
  if (Status status = checkOptions(options); !status) return status.issue();
  return withMemoryIssue("material system", "its lists", [&]() -> Result<std::unique_ptr<MaterialSystem>> {
    auto impl = std::make_unique<Impl>(device, options);
    const GlPixelStateScope scope;
    impl->shared.create();
    return std::unique_ptr<MaterialSystem>(new MaterialSystem(std::move(impl)));
  });
}

MaterialSystem::MaterialSystem(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
MaterialSystem::~MaterialSystem() = default;

Result<MaterialId> MaterialSystem::load(const std::filesystem::path& path) {
  return withMemoryIssue("material system", "a file's name", [&]() -> Result<MaterialId> {
    Result<std::unique_ptr<ByteSource>> source = openFileSource(path);
    if (!source) return source.issue();
    return load(std::shared_ptr<const ByteSource>(std::move(*source)), path.string());
  });
}

Result<MaterialId> MaterialSystem::load(std::shared_ptr<const ByteSource> source, const std::string& name) {
  return withMemoryIssue(name, "this material", [&] { return impl_->load(std::move(source), name); });
}

// Nothing changes but in addSlot().
Result<MaterialId> MaterialSystem::Impl::load(std::shared_ptr<const ByteSource> source,
                                              const std::string& name) {
  if (lost)
    return Issue{issue_id::kGlContext, Severity::kError, name,
                 "the context is lost: load materials after contextRestored()"};
  auto counted = std::make_shared<CountingSource>(std::move(source), read_bytes);
  Result<AssetFile> opened = AssetFile::open(std::move(counted), name);
  if (!opened) return opened.issue();
  const auto file = std::make_shared<const AssetFile>(std::move(*opened));
  Result<MaterialVariant> variant = materialVariant(file->skeleton(), options.lookup, options.visibility);
  if (!variant) return variant.issue();
  if (Status status = placeUnits(*variant, options, device->capabilities(), name); !status)
    return status.issue();
  std::vector<PartPlan> plan =
      planParts(file->skeleton(), *variant, options.atlas_size.value_or(file->skeleton().atlas));
  if (Status status = checkExtents(file->skeleton(), plan, device->capabilities()); !status)
    return status.issue();
  std::vector<PartDesc> descs;
  for (const PartPlan& part : plan) descs.push_back(part.desc);
  Slot made;
  made.name = name;
  made.file = file;
  made.variant = *variant;
  made.leads.resize(plan.size());
  made.gpu = MaterialGpu(file->skeleton(), *variant, name, plan.size());
  made.plan = std::move(plan);
  const uint32_t id = addSlot(std::move(made), std::move(descs));
  ++stats.materials;
  return MaterialId{id};
}

Result<TextureId> MaterialSystem::loadTexture(const ImageTexture& image) {
  return withMemoryIssue(image.name, "this texture", [&] { return impl_->loadTexture(image); });
}

// Nothing changes but in addSlot().
Result<TextureId> MaterialSystem::Impl::loadTexture(const ImageTexture& image) {
  LODEN_CHECK(image.mips);
  LODEN_CHECK_EQ(image.mips->mips, fullMipCount(image.mips->width, image.mips->height));
  if (lost)
    return Issue{issue_id::kGlContext, Severity::kError, image.name,
                 "the context is lost: load textures after contextRestored()"};
  Slot made;
  made.name = image.name;
  made.plan = planImageParts(*image.mips, isMipmapped(image), device->capabilities().max_texture_side);
  std::vector<PartDesc> descs;
  for (const PartPlan& part : made.plan) descs.push_back(part.desc);
  made.texture.emplace(image, made.plan.size());
  const uint32_t id = addSlot(std::move(made), std::move(descs));
  ++stats.textures;
  return TextureId{id};
}

// Its GL objects that are always there.
void MaterialSystem::Impl::create(Slot& slot) {
  if (slot.texture)
    slot.texture->create();
  else
    slot.gpu.create(shared);
}

// Returns the value of its id. Nothing changes but at its end, from where on nothing is allocated.
uint32_t MaterialSystem::Impl::addSlot(Slot made, std::vector<PartDesc> descs) {
  made.alive = true;
  made.serials.assign(made.plan.size(), 0);
  const GlPixelStateScope scope;
  create(made);
  if (slots.size() == slots.capacity()) slots.reserve(2 * slots.size() + 1);

  const uint32_t index = residency.add(std::move(descs));
  LODEN_CHECK_LT(index, kMaxMaterials);
  if (index >= slots.size()) slots.resize(index + 1);
  Slot& slot = slots[index];
  made.generation = slot.generation;
  slot = std::move(made);
  publish(index);
  for (const PartPlan& part : slot.plan) stats.total_bytes += part.desc.bytes;
  return (slot.generation & 0xfffu) << kIndexBits | (index + 1);
}

void MaterialSystem::unload(MaterialId id) {
  impl_->unload(impl_->indexOf(id));
  --impl_->stats.materials;
}
void MaterialSystem::unload(TextureId id) {
  impl_->unload(impl_->indexOf(id));
  --impl_->stats.textures;
}

void MaterialSystem::Impl::unload(uint32_t index) {
  Slot& slot = slots[index];
  for (uint32_t part = 0; part < slot.plan.size(); ++part) {
    loader.cancel({index, part});
    noLongerThere({index, part});
  }
  std::erase_if(uploads, [index](const UploadJob& job) { return job.ticket.ref.slot == index; });
  const auto of_slot = [index](const Demand& demand) { return demand.slot == index; };
  std::erase_if(demands, of_slot);
  std::erase_if(last_demands, of_slot);
  residency.remove(index);
  for (const PartPlan& part : slot.plan) stats.total_bytes -= part.desc.bytes;
  const uint32_t generation = slot.generation + 1;
  slot = {};
  slot.generation = generation;
}

// Of a part that was requested, and counts from then on.
void MaterialSystem::Impl::noLongerThere(PartRef ref) noexcept {
  Slot& slot = slots[ref.slot];
  if (slot.texture && slot.serials[ref.part] != 0) stats.texture_bytes -= slot.plan[ref.part].desc.bytes;
  slot.serials[ref.part] = 0;
}

void MaterialSystem::setBudget(uint64_t bytes) {
  impl_->residency.setBudget(bytes);
}

MaterialVariant MaterialSystem::variant(MaterialId id) const {
  return impl_->slotOf(id).variant;
}
const Material& MaterialSystem::material(MaterialId id) const {
  return impl_->slotOf(id).file->skeleton();
}
const MaterialStats& MaterialSystem::stats() const {
  return impl_->stats;
}
void MaterialSystem::bind(MaterialId id) {
  LODEN_CHECK(!impl_->lost);
  impl_->slotOf(id).gpu.bind();
}

uint32_t MaterialSystem::textureName(TextureId id) const {
  return impl_->slotOf(id).texture->name();
}

float MaterialSystem::residentLambda(TextureId id) const {
  return impl_->residency.publishedLambda(impl_->indexOf(id));
}
float MaterialSystem::residentLambda(MaterialId id) const {
  return shownLambda(material(id), impl_->residency.publishedLambda(impl_->indexOf(id)));
}

uint64_t MaterialSystem::reliefRevision() const {
  return impl_->relief_revision;
}

std::vector<PartStats> MaterialSystem::parts(MaterialId id) const {
  return impl_->partsOf(impl_->indexOf(id));
}
std::vector<PartStats> MaterialSystem::parts(TextureId id) const {
  return impl_->partsOf(impl_->indexOf(id));
}
std::vector<PartStats> MaterialSystem::Impl::partsOf(uint32_t index) const {
  const std::vector<PartPlan>& plan = slots[index].plan;
  std::vector<PartStats> parts;
  for (uint32_t part = 0; part < plan.size(); ++part)
    parts.push_back({partName(plan[part]), plan[part].desc.bytes, residency.resident({index, part})});
  return parts;
}

void MaterialSystem::demand(MaterialId id, float lambda) {
  impl_->demand(impl_->indexOf(id), lambda);
}
void MaterialSystem::demand(TextureId id, float lambda) {
  impl_->demand(impl_->indexOf(id), lambda);
}
void MaterialSystem::Impl::demand(uint32_t index, float lambda) {
  demands.push_back({index, lambda});
  residency.demand(index, lambda);
}

void MaterialSystem::update(float seconds) {
  Impl& impl = *impl_;
  impl.takeDeliveries();
  if (impl.lost) return impl.demands.clear();
  impl.pumpUploads();
  const Residency::Actions& actions = impl.residency.advance(seconds);
  for (PartRef ref : actions.evict) impl.evict(ref);
  for (PartRef ref : actions.load) impl.request(ref);
  impl.publishActive();
  impl.countFrame();
  impl.last_demands.swap(impl.demands);
  impl.demands.clear();
}

void MaterialSystem::finishLoading() {
  Impl& impl = *impl_;
  if (impl.lost) return;
  const std::vector<Demand> wanted = impl.demands.empty() ? impl.last_demands : impl.demands;
  do {
    if (impl.uploads.empty()) impl.loader.wait();
    impl.demands.clear();
    for (const Demand& demand : wanted) {
      impl.residency.demand(demand.slot, demand.lambda);
      impl.demands.push_back(demand);
    }
    update(0);
  } while (!impl.residency.settled());
  impl.residency.endFades();
  impl.publishActive();
}

void MaterialSystem::contextLost() {
  Impl& impl = *impl_;
  impl.lost = true;
  for (UploadJob& job : impl.uploads)
    for (GlTexture& texture : job.textures) texture.release();
  impl.uploads.clear();
  impl.shared.contextLost();
  for (Slot& slot : impl.slots) {
    slot.gpu.contextLost();
    if (slot.texture) slot.texture->contextLost();
    std::fill(slot.serials.begin(), slot.serials.end(), 0);  // what is being read no longer counts
    std::fill(slot.leads.begin(), slot.leads.end(), nullptr);
  }
  impl.residency.dropAll();
  impl.stats.texture_bytes = 0;
}

Status MaterialSystem::contextRestored() {
  Impl& impl = *impl_;
  return withMemoryIssue("material system", "the materials in a new context", [&]() -> Status {
    const GlPixelStateScope scope;
    impl.shared.create();
    for (uint32_t index = 0; index < impl.slots.size(); ++index) {
      if (!impl.slots[index].alive) continue;
      impl.create(impl.slots[index]);
      impl.publish(index);
    }
    impl.lost = false;
    return {};
  });
}

void MaterialSystem::Impl::takeDeliveries() {
  for (LoadingThreads::Delivery& delivery : loader.take()) {
    if (!current(delivery.ticket)) continue;
    if (!delivery.part) {
      fail(delivery.ticket.ref, delivery.part.issue());
      continue;
    }
    try {
      uploads.emplace_back();
    } catch (const std::bad_alloc&) {
      failForMemory(delivery.ticket.ref);
      continue;
    }
    uploads.back().ticket = delivery.ticket;
    uploads.back().part = std::move(*delivery.part);
  }
}

void MaterialSystem::Impl::fail(PartRef ref, const Issue& issue) noexcept {
  ++stats.failed_parts;
  if (issue.id == issue_id::kMemory) ++stats.failed_memory;
  noLongerThere(ref);
  residency.failed(ref);
  try {
    device->log(
        {issue.id, Severity::kWarning, issue.where, issue.text + "; a coarser level is shown instead"});
  } catch (...) {  // the counts say it
  }
}

void MaterialSystem::Impl::failForMemory(PartRef ref) noexcept {
  fail(ref, memoryIssue(slots[ref.slot].name, "a part of it"));
}

void MaterialSystem::Impl::pumpUploads() {
  const auto bound = int64_t(
      std::clamp<uint64_t>(options.upload_bytes_per_frame, 1, INT64_MAX));  // a step uploads a row at least
  int64_t budget = bound;
  std::optional<GlPixelStateScope> scope;
  if (!uploads.empty()) scope.emplace();
  while (!uploads.empty()) {
    UploadJob& job = uploads.front();
    try {
      const Pumped pumped = pumpJob(job, budget);
      if (pumped == Pumped::kUnderWay) break;
      if (pumped == Pumped::kComplete)
        finishJob(job);
      else
        fail(job.ticket.ref, {issue_id::kMemory, Severity::kWarning, slots[job.ticket.ref.slot].name,
                              "the driver has no memory for a texture"});
    } catch (const std::bad_alloc&) {
      failForMemory(job.ticket.ref);
    }
    uploads.pop_front();
  }
  stats.uploaded_last_frame = uint64_t(bound - budget);
  stats.uploaded_bytes += stats.uploaded_last_frame;
}

MaterialSystem::Impl::Pumped MaterialSystem::Impl::pumpJob(UploadJob& job, int64_t& budget) {
  while (budget > 0) {
    if (job.textures.empty() && !allocateNext(job)) return Pumped::kNoMemory;
    const PartTexture& part = job.part.textures[job.textures.size() - 1];
    if (!job.upload.step(part, job.textures.back().name(), budget)) continue;
    if (job.textures.size() == job.part.textures.size()) return Pumped::kComplete;
    if (!allocateNext(job)) return Pumped::kNoMemory;
  }
  return Pumped::kUnderWay;
}

// False if there is no memory.
bool MaterialSystem::Impl::allocateNext(UploadJob& job) {
  const PartTexture& next = job.part.textures[job.textures.size()];
  const Slot& slot = slots[job.ticket.ref.slot];
  GlTexture texture = allocateTexture(
      next, slot.name + " " + (slot.texture ? partName(slot.plan[job.ticket.ref.part]) : next.label));
  if (!texture) return false;
  job.textures.push_back(std::move(texture));
  job.upload = {};
  return true;
}

void MaterialSystem::Impl::finishJob(UploadJob& job) {
  Slot& slot = slots[job.ticket.ref.slot];
  const uint32_t part = job.ticket.ref.part;
  if (slot.texture) {
    slot.texture->setPart(part, std::move(job.textures.front()), job.part.textures.front());
  } else {
    slot.gpu.setPart(part, std::move(job.textures), job.part);
    slot.leads[part] = std::move(job.part.lead);
  }
  residency.arrived(job.ticket.ref);
}

void MaterialSystem::Impl::evict(PartRef ref) {
  Slot& slot = slots[ref.slot];
  noLongerThere(ref);
  if (slot.texture) {
    slot.texture->dropPart(ref.part);
  } else {
    slot.gpu.dropPart(ref.part);
    slot.leads[ref.part].reset();
    loader.cancel(ref);
  }
  std::erase_if(uploads, [ref](const UploadJob& job) { return job.ticket.ref == ref; });
  ++stats.evicted_parts;
}

void MaterialSystem::Impl::request(PartRef ref) {
  Slot& slot = slots[ref.slot];
  slot.serials[ref.part] = next_serial++;
  const PartPlan& plan = slot.plan[ref.part];
  if (slot.texture) return requestMips(ref);
  std::shared_ptr<const Material> lead;
  for (uint32_t part = 0; part < ref.part; ++part)
    if (slot.plan[part].kind == plan.kind && slot.plan[part].band == plan.band)
      lead = std::exchange(slot.leads[part], {});
  try {
    loader.request({{ref, slot.serials[ref.part]}, slot.file, plan, std::move(lead), options.atlas_threads});
  } catch (const std::bad_alloc&) {
    failForMemory(ref);
  }
}

// They are in memory, and go straight to the uploads.
void MaterialSystem::Impl::requestMips(PartRef ref) {
  Slot& slot = slots[ref.slot];
  const PartPlan& plan = slot.plan[ref.part];
  stats.texture_bytes += plan.desc.bytes;
  try {
    UploadJob job{{ref, slot.serials[ref.part]}, {}, {}, {}};
    job.part.textures.push_back(imagePart(slot.texture->image(), plan));
    uploads.push_back(std::move(job));
  } catch (const std::bad_alloc&) {
    failForMemory(ref);
  }
}

ResidentState MaterialSystem::Impl::residentState(uint32_t index) const {
  const Slot& slot = slots[index];
  ResidentState state;
  state.lambda = residency.publishedLambda(index);
  for (uint32_t part = 0; part < slot.plan.size(); ++part) {
    if (!residency.resident({index, part})) continue;
    const PartPlan& plan = slot.plan[part];
    const uint32_t band = 1u << plan.band;
    const bool lead = plan.share == Share::kLead;
    if (plan.kind == PartKind::kBand) {
      state.bands |= band;
      state.leads = lead ? state.leads | band : state.leads & ~band;
      state.rest[size_t(plan.band)] = plan.desc.refines ? residency.shownShare({index, part}) : 1;
    }
    if (plan.kind == PartKind::kSurface) state.surface = true, state.tail = lead;
    if (plan.kind == PartKind::kGeometry) state.atlas = plan.atlas;
  }
  return state;
}

void MaterialSystem::Impl::publishActive() {
  for (const uint32_t index : residency.active()) publish(index);
}

void MaterialSystem::Impl::countFrame() {
  stats.resident_bytes = residency.committedBytes();
  stats.peak_bytes = std::max(stats.peak_bytes, stats.resident_bytes);
  stats.parts_resident = residency.residentParts();
  stats.parts_in_flight = residency.loadingParts();
  stats.read_bytes = read_bytes;
}

}  // namespace loden::runtime
