// A BTF that is read one view at a time, whatever it comes from: a bake, a cooked material or a measured set.
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
  // One view: values that include the light's cosine (white Lambert: cos theta_i), [light][texel] linear RGB,
  // texel = j * width + i. Thread safe.
  virtual Result<std::vector<glm::vec3>> view(int view) const = 0;
};

// The BTF of a bake, which must have one. Values are repaired if the bake has a repair log.
Result<std::unique_ptr<BtfSource>> bakedSource(BakedOutput baked);

// Prepares the evaluator of the asset at `path` for a look-up, and returns the look-up that it will use: as
// in the runtime, kPaper in place of kDefault if the asset has only the published map. Mode lod has no
// look-up. Issues: kOption if the asset lacks what the look-up reads.
Result<Lookup> prepareLookup(Evaluator& evaluator, Lookup lookup, const std::filesystem::path& path);

// How materialSource samples a material: at the centres of `side` x `side` texels.
struct MaterialSampling {
  int side = 0;  // texels per side; 0: the material's own at lambda
  double lambda = 0;
  Lookup lookup = Lookup::kDefault;
  Domain domain = Domain::kReference;  // kFlat: the texel is p itself, so that there is no parallax
  DirectionSet lights, views;
};
// The BTF of a material. The evaluator must outlive it.
std::unique_ptr<BtfSource> materialSource(const Evaluator& evaluator, MaterialSampling sampling);

// One slice of a material's BTF: [texel] linear RGB for the given directions.
std::vector<glm::vec3> materialSlice(const Evaluator& evaluator, const MaterialSampling& sampling,
                                     const glm::dvec3& wi, const glm::dvec3& wo);

}  // namespace loden::importer
