// A BTF in memory for the tests of the fits.
#pragma once

#include <functional>
#include <string>

#include "importer/btf/btf_source.h"

namespace loden::importer {

class SyntheticSource : public BtfSource {
 public:
  using Value = std::function<glm::dvec3(glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3& wo)>;
  SyntheticSource(int side, DirectionSet set, Value value)
      : side_(side), set_(std::move(set)), value_(std::move(value)) {}

  const std::string& name() const override { return name_; }
  glm::ivec2 size() const override { return {side_, side_}; }
  const DirectionSet& lights() const override { return set_; }
  const DirectionSet& views() const override { return set_; }
  Result<std::vector<glm::vec3>> view(int view) const override {
    std::vector<glm::vec3> out;
    for (const glm::dvec3& wi : set_.samples)
      for (int t = 0; t < side_ * side_; ++t)
        out.push_back(value_(glm::dvec2(t % side_ + 0.5, t / side_ + 0.5) / double(side_), wi,
                             set_.samples[size_t(view)]));
    return out;
  }
  glm::dvec3 valueAt(glm::dvec2 x, const glm::dvec3& wi, const glm::dvec3& wo) const {
    return value_(x, wi, wo);
  }

 private:
  std::string name_ = "synthetic";
  int side_;
  DirectionSet set_;
  Value value_;
};

}  // namespace loden::importer
