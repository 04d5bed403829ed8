// Measured BTFs as BtfSource, and the check that tells whether their values contain the light's cosine.
#pragma once

#include <filesystem>
#include <memory>

#include "importer/btf/btf_source.h"

namespace loden::importer {

// What a measured set says of itself, besides its images.
enum class CosineFlag { kUnknown, kIncluded, kNotIncluded };

class MeasuredSource : public BtfSource {
 public:
  virtual CosineFlag cosineFlag() const = 0;  // as its header states it
  virtual std::string format() const = 0;     // for reports: "UBO2014 DFMF", "Bonn image folder"
};

// A folder of Bonn's naming (bonn_folder.h) or a Bonn .btf file (btf_file.h), told apart by what is there.
Result<std::unique_ptr<MeasuredSource>> openMeasured(const std::filesystem::path& path);

// f(l, v) and f(v, l) of the texels' mean differ by cos(theta_l) / cos(theta_v) if values contain the light's
// cosine, and not at all if they are a BRDF (Helmholtz). The slope of log f(l,v) - log f(v,l) over
// log(cos l / cos v), by least squares through the origin, is then 1 or 0.
struct Reciprocity {
  double slope = 0;
  double r_squared = 0;
  int pairs = 0;  // used: both values positive, the two cosines apart
  // Far enough from the middle, with enough pairs, to decide.
  bool decisive() const { return pairs >= 20 && (slope < 0.35 || slope > 0.65); }
  bool cosineIncluded() const { return slope > 0.5; }
  // False where neither a BRDF nor one with the cosine would be so: the values have a wrong gamma, say.
  bool plausible() const { return pairs < 20 || (slope > -0.5 && slope < 1.5); }
};
Result<Reciprocity> checkReciprocity(const BtfSource& source, int threads);

// The source with the light's cosine in its values, whether it came with it or not: decided by the check
// where that is decisive, else by the source's flag, else taken as included. `note` says what was found, and
// if the flag disagrees.
Result<std::unique_ptr<BtfSource>> withCosine(std::unique_ptr<BtfSource> source, CosineFlag flag, int threads,
                                              std::string& note);

}  // namespace loden::importer
