#include "importer/btf/btf_source.h"

#include <algorithm>

#include "importer/btf/finite_source.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

class BakedSource : public BtfSource {
 public:
  explicit BakedSource(BakedOutput baked) : baked_(std::move(baked)), name_(baked_.folder().string()) {}
  const std::string& name() const override { return name_; }
  glm::ivec2 size() const override { return glm::ivec2(baked_.manifest().size); }
  const DirectionSet& lights() const override { return baked_.manifest().directions; }
  const DirectionSet& views() const override { return baked_.manifest().directions; }
  Result<std::vector<glm::vec3>> view(int view) const override { return baked_.btfView(view); }

 private:
  BakedOutput baked_;
  std::string name_;
};

int sideAt(const Evaluator& evaluator, const MaterialSampling& sampling) {
  if (sampling.side > 0) return sampling.side;
  return std::max(1, evaluator.material().side >> static_cast<int>(sampling.lambda));
}

// Where texel (i, j) of the flat domain lies, seen from wo: the hit that a lookup would have ended in.
Hit<float> flatHit(const Evaluator& evaluator, glm::dvec2 p, double lambda, const glm::dvec3& wo) {
  Hit<float> hit;
  hit.p = p;
  hit.x = p;
  hit.lambda = static_cast<float>(lambda);
  const GeometryImage& geometry = evaluator.material().geometry;
  if (geometry.empty()) return hit;
  const auto point = surfaceAt(geometry, p);
  if (point.chart == 0) return hit;
  hit.depth = static_cast<float>(point.position.z);
  hit.x = glm::dvec2(point.position) -
          glm::dvec2(wo) * periodsPerLength(geometry.aspect) / wo.z * point.position.z;
  return hit;
}

Hit<float> hitAt(const Evaluator& evaluator, const MaterialSampling& sampling, glm::dvec2 texel,
                 const glm::dvec3& wo) {
  if (sampling.domain == Domain::kFlat) return flatHit(evaluator, texel, sampling.lambda, wo);
  return evaluator.findHit(glm::vec2(texel), static_cast<float>(sampling.lambda), glm::vec3(wo),
                           sampling.lookup);
}

class MaterialSource : public BtfSource {
 public:
  MaterialSource(const Evaluator& evaluator, MaterialSampling sampling)
      : evaluator_(evaluator), sampling_(std::move(sampling)) {
    sampling_.side = sideAt(evaluator, sampling_);
  }
  const std::string& name() const override { return evaluator_.material().name; }
  glm::ivec2 size() const override { return glm::ivec2(sampling_.side); }
  const DirectionSet& lights() const override { return sampling_.lights; }
  const DirectionSet& views() const override { return sampling_.views; }

  Result<std::vector<glm::vec3>> view(int view) const override {
    const int side = sampling_.side, lights = sampling_.lights.size();
    const size_t texels = size_t(side) * side;
    const glm::dvec3 wo = sampling_.views.samples[view];
    // A BTF's values are in white units, pi times radiance under unit irradiance.
    const double scale = double(evaluator_.material().value_scale) * kPi;
    const float white = std::abs(scale - 1) < 1e-6 ? 1.0f : static_cast<float>(scale);
    std::vector<glm::vec3> values(texels * lights);
    for (size_t texel = 0; texel < texels; ++texel) {
      const glm::dvec2 centre((texel % side + .5) / side, (texel / side + .5) / side);
      const Hit<float> hit = hitAt(evaluator_, sampling_, centre, wo);
      for (int l = 0; l < lights; ++l)
        values[l * texels + texel] =
            white * evaluator_.evaluate(hit, glm::vec3(sampling_.lights.samples[l]), glm::vec3(wo));
    }
    return values;
  }

 private:
  const Evaluator& evaluator_;
  MaterialSampling sampling_;
};

}  // namespace

Result<std::unique_ptr<BtfSource>> bakedSource(BakedOutput baked) {
  if (!baked.manifest().has_btf)
    return Issue{issue_id::kBakeManifest, Severity::kError, baked.folder().string(),
                 "holds no BTF; bake with --maps btf"};
  auto repairs = baked.repairs();
  std::unique_ptr<BtfSource> source = std::make_unique<BakedSource>(std::move(baked));
  return repairs ? repairedSource(std::move(source), std::move(repairs)) : std::move(source);
}

Result<Lookup> prepareLookup(Evaluator& evaluator, Lookup lookup, const std::filesystem::path& path) {
  const Material& material = evaluator.material();
  if (material.mode == Mode::kLod || lookup == Lookup::kNone) return Lookup::kNone;
  const auto refuse = [&](const std::string& why) {
    return Issue{issue_id::kOption, Severity::kError, path.string(),
                 "cannot be looked up by --lookup " + std::string(lookupName(lookup)) + ": " + why};
  };
  const bool has_atlas = !evaluator.atlas().depth.empty();
  if (lookup == Lookup::kPaper && !material.stored_vdim)
    return refuse(
        "the asset has no published indirection map; cook the bake with --mode surface --preset seed");
  if (lookup == Lookup::kDefault && !has_atlas) return material.stored_vdim ? Lookup::kPaper : Lookup::kNone;
  if (lookup != Lookup::kPaper && !has_atlas)
    return refuse("the asset has no geometry image; bake with --maps surface and cook again");
  if (lookup == Lookup::kQuality && material.geometry.side() > kMostCubicSide)
    return refuse("its geometry image has more than " + std::to_string(kMostCubicSide) +
                  " texels a side; bake with a smaller --geometry-size");
  if (lookup == Lookup::kQuality) evaluator.prepareQuality();
  return lookup;
}

std::unique_ptr<BtfSource> materialSource(const Evaluator& evaluator, MaterialSampling sampling) {
  return std::make_unique<MaterialSource>(evaluator, std::move(sampling));
}

std::vector<glm::vec3> materialSlice(const Evaluator& evaluator, const MaterialSampling& sampling,
                                     const glm::dvec3& wi, const glm::dvec3& wo) {
  MaterialSampling one = sampling;
  one.lights.samples = {wi};
  one.views.samples = {wo};
  return materialSource(evaluator, std::move(one))->view(0).value();
}

}  // namespace loden::importer
