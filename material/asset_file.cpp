#include "material/asset.h"
#include "material/asset_content.h"

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
    // META is optional: what is wrong with it is for validateAsset to say.
    if (const Result<Material> meta = file.loadPart(kMeta)) file.skeleton_.meta_json = meta->meta_json;
    return file;
  });
}

uint64_t AssetFile::partStoredBytes(uint32_t type, int band) const {
  const int chunk = chunkOfPart(chunks_, skeleton_, {type, band});
  return chunk >= 0 && chunk < present_chunks_ ? chunks_[chunk].stored_bytes : 0;
}

uint64_t AssetFile::bandStoredBytes(int band) const {
  LODEN_CHECK(band >= 0 && band < static_cast<int>(skeleton_.bands.size()));
  return partStoredBytes(kBand, band);
}
uint64_t AssetFile::geometryStoredBytes() const {
  return partStoredBytes(kGeom);
}
uint64_t AssetFile::storedVdimStoredBytes() const {
  return partStoredBytes(kVdim);
}
uint64_t AssetFile::surfaceStoredBytes() const {
  return partStoredBytes(kSurf);
}

Result<Material> AssetFile::loadPart(uint32_t type, int band) const {
  return withoutExceptions(name_, [&]() -> Result<Material> {
    IssueList issues(name_);
    const int chunk = chunkOfPart(chunks_, skeleton_, {type, band});
    if (chunk < 0 || chunk >= present_chunks_) {
      issues.add(issue_id::kMissingChunk, chunkName(type), "the asset has no such part, or ends before it");
      return issues.first();
    }
    Material part;
    if (type == kBand) part.bands = {skeleton_.bands[band]};
    if (type == kGeom) part.geometry = skeleton_.geometry;
    if (type == kVdim) part.stored_vdim = skeleton_.stored_vdim;
    if (type == kSurf) part.surface = skeleton_.surface;
    asset::loadPart(*source_, chunks_[chunk], chunk, {type, type == kBand ? 0 : -1}, part, issues);
    if (!issues.empty()) return issues.first();
    return part;
  });
}

Result<Band> AssetFile::loadBand(int band) const {
  LODEN_CHECK(band >= 0 && band < static_cast<int>(skeleton_.bands.size()));
  Result<Material> part = loadPart(kBand, band);
  if (!part) return part.issue();
  return std::move(part->bands.front());
}

Result<GeometryImage> AssetFile::loadGeometry() const {
  Result<Material> part = loadPart(kGeom);
  if (!part) return part.issue();
  return std::move(part->geometry);
}

Result<PaperVdim> AssetFile::loadStoredVdim() const {
  Result<Material> part = loadPart(kVdim);
  if (!part) return part.issue();
  return std::move(*part->stored_vdim);
}

Result<SurfaceMaps> AssetFile::loadSurface() const {
  Result<Material> part = loadPart(kSurf);
  if (!part) return part.issue();
  return std::move(*part->surface);
}

}  // namespace loden
