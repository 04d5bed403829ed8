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
  Result<Material> meta = load(kMeta, -1, Share::kLead);
  if (meta) return std::move(meta->meta_json);
  if (meta.issue().id == issue_id::kMissingChunk) return std::string();
  return meta.issue();
}

uint64_t AssetFile::storedBytes(const MaterialPart& of, Share share) const {
  LODEN_CHECK(of.kind != PartKind::kBand ||
              (of.band >= 0 && of.band < static_cast<int>(skeleton_.bands.size())));
  uint64_t bytes = 0;
  for (const Part& part : partsOf(skeleton_, chunkTypeOf(of.kind), of.band, share)) {
    const int chunk = chunkOfPart(chunks_, skeleton_, part);
    if (chunk >= 0 && chunk < present_chunks_) bytes += chunks_[chunk].stored_bytes;
  }
  return bytes;
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
    const Material described = describedPart(skeleton_, type, band);
    Material material = lead ? std::move(*lead) : described;
    for (Part part : partsOf(skeleton_, type, band, share)) {
      if (lead && !part.rest) continue;
      const int chunk = chunkOfPart(chunks_, skeleton_, part);
      const bool present = chunk >= 0 && chunk < present_chunks_;
      issues.require(present, issue_id::kMissingChunk, chunkName(type),
                     "the asset has no such part, or ends before it");
      if (type == kBand) part.band = 0;
      if (present) asset::loadPart(*source_, chunks_[chunk], chunk, part, described, material, issues);
      if (!issues.empty()) return issues.first();
    }
    return material;
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
  Result<Material> part = load(kGeom, -1, Share::kWhole);
  if (!part) return part.issue();
  return std::move(part->geometry);
}

Result<PaperVdim> AssetFile::loadStoredVdim() const {
  Result<Material> part = load(kVdim, -1, Share::kWhole);
  if (!part) return part.issue();
  return std::move(*part->stored_vdim);
}

Result<SurfaceMaps> AssetFile::loadSurface(Share share, const SurfaceMaps* lead) const {
  Result<Material> part = withoutExceptions(name_, [&] {
    std::optional<Material> leading;
    if (lead) leading.emplace().surface = *lead;
    return load(kSurf, -1, share, std::move(leading));
  });
  if (!part) return part.issue();
  return std::move(*part->surface);
}

}  // namespace loden
