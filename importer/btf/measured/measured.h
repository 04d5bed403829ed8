// Measured BTFs as BtfSource, and a check whether their values contain the light's cosine.
#pragma once

#include <filesystem>
#include <memory>

#include "importer/btf/btf_source.h"

namespace loden::importer {

// What the file says about the cosine.
enum class CosineFlag { kUnknown, kIncluded, kNotIncluded };

class MeasuredSource : public BtfSource {
 public:
  virtual CosineFlag cosineFlag() const = 0;  // as the file's header states it
  virtual std::string format() const = 0;     // for reports: "UBO2014 DFMF", "Bonn image folder"
};

// The measured BTF at a path: a folder in Bonn's naming (bonn_folder.h) or a Bonn .btf file (btf_file.h).
Result<std::unique_ptr<MeasuredSource>> openMeasured(const std::filesystem::path& path);

// The result of a check of reciprocity. f(l, v) and f(v, l) of the mean over the texels differ by
// cos(theta_l) / cos(theta_v) if values contain the light's cosine, and are equal if they are a BRDF
// (Helmholtz). The slope of log f(l,v) - log f(v,l) over log(cos l / cos v), by least squares through the
// origin, is therefore 1 or 0.
struct Reciprocity {
  double slope = 0;
  double r_squared = 0;
  int pairs = 0;  // pairs that were used: both values are positive, and the two cosines differ
  // Whether the slope is far enough from the middle, with enough pairs, to decide.
  bool decisive() const { return pairs >= 20 && (slope < 0.35 || slope > 0.65); }
  bool cosineIncluded() const { return slope > 0.5; }
  // Whether the slope is possible for a BRDF with or without the cosine; if not, the values have, for
  // example, a wrong gamma.
  bool plausible() const { return pairs < 20 || (slope > -0.5 && slope < 1.5); }
};
Result<Reciprocity> checkReciprocity(const BtfSource& source, int threads);

// The source with the light's cosine in its values, whether it had it or not. This is decided by the check of
// reciprocity if that is decisive, else by the source's flag, else the cosine is assumed to be included.
// `note` is set to a text about what was found, and whether the flag disagrees.
Result<std::unique_ptr<BtfSource>> withCosine(std::unique_ptr<BtfSource> source, CosineFlag flag, int threads,
                                              std::string& note);

}  // namespace loden::importer
