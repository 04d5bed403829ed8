// A BTF read one view at a time, whatever it comes from: a bake, a cooked material, a measured set.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "importer/btf/baked_output.h"
#include "material/base/result.h"
#include "material/eval/evaluate.h"
#include "material/model/directions.h"

namespace loden::importer {

class BtfSource {
 public:
  virtual ~BtfSource() = default;
  virtual const std::string& name() const = 0;
  virtual glm::ivec2 size() const = 0;  // texels, width and height
  virtual const DirectionSet& lights() const = 0;
  virtual const DirectionSet& views() const = 0;
  // Values with the light's cosine in them (white Lambert: cos theta_i),
  // [light][texel] linear RGB, texel = j * width + i. Thread safe.
  virtual Result<std::vector<glm::vec3>> view(int view) const = 0;
};

// The BTF of a bake. It must have one. Repaired if the bake has a log of repairs.
Result<std::unique_ptr<BtfSource>> bakedSource(BakedOutput baked);

// Makes the evaluator of the asset at `path` ready for a lookup that was asked for by name, and returns the
// one that it will serve: as in the runtime, kPaper for kDefault where there is only the published map. Mode
// lod has no parallax to look up. Issues: kOption where the asset has not got what the lookup reads.
Result<Lookup> prepareLookup(Evaluator& evaluator, Lookup lookup, const std::filesystem::path& path);

// A material at the centres of `side` x `side` texels. The evaluator must outlive it.
struct MaterialSampling {
  int side = 0;  // 0: the material's own at lambda
  double lambda = 0;
  Lookup lookup = Lookup::kDefault;
  Domain domain = Domain::kReference;  // flat: the texel is p itself, so that no parallax is seen
  DirectionSet lights, views;
};
std::unique_ptr<BtfSource> materialSource(const Evaluator& evaluator, MaterialSampling sampling);

// One slice of a material: [texel] linear RGB at the given directions.
std::vector<glm::vec3> materialSlice(const Evaluator& evaluator, const MaterialSampling& sampling,
                                     const glm::dvec3& wi, const glm::dvec3& wo);

}  // namespace loden::importer
