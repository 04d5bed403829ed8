#include "material/asset/asset.h"
#include "material/asset/asset_content.h"

namespace loden {

using namespace asset;  // NOLINT: this file is the other half of it

Result<AssetFile> AssetFile::open(std::shared_ptr<const ByteSource> source, const std::string& name) {
  return withoutExceptions(name, [&]() -> Result<AssetFile> {
    IssueList issues(name);
    Contents contents = readContents(*source, issues);
    if (!issues.empty()) return issues.first();
    AssetFile file;
    file.source_ = std::move(source);
    file.name_ = name;
    file.skeleton_ = std::move(contents.skeleton);
    file.chunks_ = std::move(contents.chunks);
    file.present_chunks_ = contents.present;
    return file;
  });
}

Result<std::string> AssetFile::loadMeta() const {
  Result<Material> meta = load(kMeta, -1, Share::kFirst);
  if (meta) return std::move(meta->meta_json);
  if (meta.issue().id == issue_id::kMissingChunk) return std::string();
  return meta.issue();
}

uint64_t AssetFile::storedBytes(uint32_t type, int band, Share share) const {
  uint64_t bytes = 0;
  for (const Part& part : partsOf(skeleton_)) {
    if (part.type != type || part.band != band) continue;
    if (share == Share::kFirst && part.share == Part::Share::kRest) continue;
    const int chunk = chunkOfPart(chunks_, skeleton_, part);
    if (chunk >= 0 && chunk < present_chunks_) bytes += chunks_[chunk].stored_bytes;
  }
  return bytes;
}

uint64_t AssetFile::bandStoredBytes(int band, Share share) const {
  LODEN_CHECK(band >= 0 && band < static_cast<int>(skeleton_.bands.size()));
  return storedBytes(kBand, band, share);
}
uint64_t AssetFile::geometryStoredBytes() const {
  return storedBytes(kGeom, -1, Share::kAll);
}
uint64_t AssetFile::storedVdimStoredBytes() const {
  return storedBytes(kVdim, -1, Share::kAll);
}
uint64_t AssetFile::surfaceStoredBytes(Share share) const {
  return storedBytes(kSurf, -1, share);
}

namespace {

// What is described of this type, without texels, as all that a material has.
Material describedPart(const Material& skeleton, uint32_t type, int band) {
  Material part;
  if (type == kBand) part.bands = {skeleton.bands[band]};
  if (type == kGeom) part.geometry = skeleton.geometry;
  if (type == kVdim) part.stored_vdim = skeleton.stored_vdim;
  if (type == kSurf) part.surface = skeleton.surface;
  return part;
}

}  // namespace

Result<Material> AssetFile::load(uint32_t type, int band, Share share, std::optional<Material> lead) const {
  return withoutExceptions(name_, [&]() -> Result<Material> {
    IssueList issues(name_);
    const auto presentChunk = [&](const Part& part) {
      const int chunk = chunkOfPart(chunks_, skeleton_, part);
      const bool present = chunk >= 0 && chunk < present_chunks_;
      issues.require(present, issue_id::kMissingChunk, chunkName(type),
                     "the asset has no such part, or ends before it");
      return present ? chunk : -1;
    };
    const Part first = firstPart(skeleton_, type, band);
    const int band_here = type == kBand ? 0 : -1;
    const Material described = describedPart(skeleton_, type, band);
    Material part = lead ? std::move(*lead) : described;
    if (!lead) {
      const int chunk = presentChunk(first);
      if (chunk < 0) return issues.first();
      asset::loadPart(*source_, chunks_[chunk], chunk, {type, band_here, first.share}, part, issues);
    }
    if (share == Share::kAll && first.share == Part::Share::kLead && issues.empty()) {
      const int chunk = presentChunk({type, band, Part::Share::kRest});
      if (chunk < 0) return issues.first();
      loadRest(*source_, chunks_[chunk], chunk, {type, band_here, Part::Share::kRest}, described, part,
               issues);
    }
    if (!issues.empty()) return issues.first();
    return part;
  });
}

Result<Band> AssetFile::loadBand(int band, Share share, const Band* lead) const {
  LODEN_CHECK(band >= 0 && band < static_cast<int>(skeleton_.bands.size()));
  Result<Material> part = withoutExceptions(name_, [&] {
    std::optional<Material> leading;
    if (lead) leading.emplace().bands = {*lead};
    return load(kBand, band, share, std::move(leading));
  });
  if (!part) return part.issue();
  return std::move(part->bands.front());
}

Result<GeometryImage> AssetFile::loadGeometry() const {
  Result<Material> part = load(kGeom, -1, Share::kAll);
  if (!part) return part.issue();
  return std::move(part->geometry);
}

Result<PaperVdim> AssetFile::loadStoredVdim() const {
  Result<Material> part = load(kVdim, -1, Share::kAll);
  if (!part) return part.issue();
  return std::move(*part->stored_vdim);
}

Result<SurfaceMaps> AssetFile::loadSurface(Share share, const SurfaceMaps* tail) const {
  Result<Material> part = withoutExceptions(name_, [&] {
    std::optional<Material> leading;
    if (tail) leading.emplace().surface = *tail;
    return load(kSurf, -1, share, std::move(leading));
  });
  if (!part) return part.issue();
  return std::move(*part->surface);
}

}  // namespace loden
