#include <algorithm>
#include <cmath>
#include <cstdio>
#include <mutex>
#include <optional>

#include "importer/base/parallel.h"
#include "importer/btf/measured/measured.h"

namespace loden::importer {
namespace {

// Mean luminance over all texels, [view][light].
Result<std::vector<double>> meanLuminances(const BtfSource& source, int threads) {
  const size_t views = source.views().size(), lights = source.lights().size();
  const size_t texels = size_t(source.size().x) * source.size().y;
  std::vector<double> means(views * lights);
  std::optional<Issue> issue;
  std::mutex mutex;
  parallelFor(views, threads, [&](size_t view) {
    const auto values = source.view(static_cast<int>(view));
    if (!values) {
      const std::lock_guard lock(mutex);
      issue = values.issue();
      return;
    }
    for (size_t light = 0; light < lights; ++light) {
      double sum = 0;
      for (size_t t = 0; t < texels; ++t) {
        const glm::vec3& rgb = (*values)[light * texels + t];
        sum += 0.299 * rgb.x + 0.587 * rgb.y + 0.114 * rgb.z;
      }
      means[view * lights + light] = sum / double(texels);
    }
  });
  if (issue) return *issue;
  return means;
}

class CosineApplied : public BtfSource {
 public:
  explicit CosineApplied(std::unique_ptr<BtfSource> source) : source_(std::move(source)) {}
  const std::string& name() const override { return source_->name(); }
  glm::ivec2 size() const override { return source_->size(); }
  const DirectionSet& lights() const override { return source_->lights(); }
  const DirectionSet& views() const override { return source_->views(); }
  Result<std::vector<glm::vec3>> view(int view) const override {
    auto values = source_->view(view);
    if (!values) return values;
    const size_t texels = size_t(size().x) * size().y;
    for (size_t i = 0; i < values->size(); ++i)
      (*values)[i] *= static_cast<float>(lights().samples[i / texels].z);
    return values;
  }

 private:
  std::unique_ptr<BtfSource> source_;
};

}  // namespace

Result<Reciprocity> checkReciprocity(const BtfSource& source, int threads) {
  const auto means = meanLuminances(source, threads);
  if (!means) return means.issue();
  const int lights = source.lights().size(), views = source.views().size();
  // The light that is the same direction as each view.
  std::vector<int> twin(views, -1);
  for (int v = 0; v < views; ++v) {
    const int light = nearestDirection(source.lights(), source.views().samples[v]);
    if (glm::dot(source.lights().samples[light], source.views().samples[v]) > 1 - 1e-6) twin[v] = light;
  }
  Reciprocity result;
  double xx = 0, xy = 0, yy = 0;
  for (int a = 0; a < views; ++a)
    for (int b = a + 1; b < views; ++b) {
      if (twin[a] < 0 || twin[b] < 0) continue;
      // Light a seen from b, and light b seen from a.
      const double ab = (*means)[size_t(b) * lights + twin[a]], ba = (*means)[size_t(a) * lights + twin[b]];
      const double x = std::log(source.views().samples[a].z / source.views().samples[b].z);
      if (!(ab > 0) || !(ba > 0) || std::abs(x) < 1e-3) continue;
      const double y = std::log(ab) - std::log(ba);
      xx += x * x, xy += x * y, yy += y * y;
      ++result.pairs;
    }
  if (xx > 0) result.slope = xy / xx;
  if (yy > 0 && xx > 0) result.r_squared = xy * xy / (xx * yy);
  return result;
}

Result<std::unique_ptr<BtfSource>> withCosine(std::unique_ptr<BtfSource> source, CosineFlag flag, int threads,
                                              std::string& note) {
  const auto check = checkReciprocity(*source, threads);
  if (!check) return check.issue();
  const bool flag_says = flag != CosineFlag::kNotIncluded;
  const bool included = check->decisive() ? check->cosineIncluded() : flag_says;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "reciprocity slope %.2f over %d pairs (1: values contain cos(theta_light), 0: they do not): %s",
      check->slope, check->pairs,
      check->decisive() ? (included ? "contained" : "not contained, multiplied in") : "undecided");
  note = text;
  if (!check->plausible())
    note +=
        ". WARNING: a measured surface has a slope near 0 or 1. A slope near 2 comes of a wrong gamma: "
        "values stored linearly in 8-bit images, which are decoded as sRGB. Store them as EXR or HDR, "
        "which are taken as linear";
  if (check->decisive() && flag != CosineFlag::kUnknown && flag_says != included)
    note += "; the header's flag says otherwise";
  if (!check->decisive())
    note += flag == CosineFlag::kUnknown ? "; taken as contained" : "; the header's flag is taken";
  if (included) return source;
  return std::unique_ptr<BtfSource>(std::make_unique<CosineApplied>(std::move(source)));
}

}  // namespace loden::importer
