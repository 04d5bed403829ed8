#include "importer/btf/compare.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "importer/base/flip.h"
#include "importer/base/parallel.h"
#include "importer/base/progress.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

constexpr double kLowTheta = 60.0 * kPi / 180.0;

// What one view contributes; merged in the order of views.
struct ViewDifference {
  ErrorSums sums;
  std::vector<double> image_rmse_y;
  double flip = 0;
};

Issue mismatch(const BtfSource& reference, const BtfSource& test, const std::string& what) {
  return {issue_id::kOption, Severity::kError, reference.name() + " and " + test.name(), what};
}

std::string extentText(glm::ivec2 size) {
  return std::to_string(size.x) + "x" + std::to_string(size.y);
}

Status checkComparable(const BtfSource& reference, const BtfSource& test, int level) {
  const int block = 1 << level;
  if (reference.size().x % block || reference.size().y % block)
    return mismatch(reference, test, extentText(reference.size()) + " texels cannot be halved that often");
  if (reference.size() / block != test.size())
    return mismatch(
        reference, test,
        "have " + extentText(reference.size() / block) + " and " + extentText(test.size()) + " texels");
  if (reference.views().size() != test.views().size() || reference.lights().size() != test.lights().size())
    return mismatch(reference, test, "are sampled at different directions");
  return {};
}

Result<ViewDifference> compareView(const BtfSource& reference, const BtfSource& test,
                                   const CompareOptions& options, int view) {
  const auto truth = reference.view(view), candidate = test.view(view);
  if (!truth) return truth.issue();
  if (!candidate) return candidate.issue();
  const glm::ivec2 size = test.size();
  const size_t texels = size_t(size.x) * size.y;
  const size_t fine_texels = size_t(reference.size().x) * reference.size().y;
  const int lights = reference.lights().size(), flip_light = 37 * view % lights;
  ViewDifference difference;
  const auto image = [&](int light) {
    return boxAveraged(std::span(*truth).subspan(light * fine_texels, fine_texels), reference.size(),
                       options.level);
  };
  for (int light = 0; light < lights; light += options.every) {
    ErrorSums sums;
    sums.add(image(light), std::span(*candidate).subspan(light * texels, texels));
    difference.image_rmse_y.push_back(sums.y().rmse);
    difference.sums.merge(sums);
  }
  const auto candidate_image = std::span(*candidate).subspan(flip_light * texels, texels);
  difference.flip = flip(image(flip_light), candidate_image, size.x, size.y).mean;
  return difference;
}

BtfDifference merged(const std::vector<std::optional<ViewDifference>>& views, const DirectionSet& directions,
                     int every) {
  BtfDifference total;
  int count = 0;
  for (size_t i = 0; i < views.size(); ++i) {
    const ViewDifference& view = *views[i];
    const double theta = sphericalFromDirection(directions.samples[i * every]).theta;
    (theta <= kLowTheta + 1e-6 ? total.low : total.high).merge(view.sums);
    total.all.merge(view.sums);
    total.flip_mean += view.flip;
    ++count;
    for (const double rmse : view.image_rmse_y) {
      total.image_rmse_y.mean += rmse;
      total.image_rmse_y.min = std::min(total.image_rmse_y.min, rmse);
      total.image_rmse_y.max = std::max(total.image_rmse_y.max, rmse);
      ++total.images;
    }
  }
  total.image_rmse_y.mean /= std::max(1, total.images);
  total.flip_mean /= std::max(1, count);
  return total;
}

}  // namespace

std::vector<glm::vec3> boxAveraged(std::span<const glm::vec3> image, glm::ivec2 size, int level) {
  if (level == 0) return {image.begin(), image.end()};
  const int block = 1 << level;
  const glm::ivec2 coarse = size / block;
  std::vector<glm::vec3> out(size_t(coarse.x) * coarse.y);
  for (int y = 0; y < coarse.y; ++y)
    for (int x = 0; x < coarse.x; ++x) {
      glm::dvec3 sum(0);
      for (int k = 0; k < block * block; ++k)
        sum += glm::dvec3(image[size_t(y * block + k / block) * size.x + x * block + k % block]);
      out[size_t(y) * coarse.x + x] = sum / double(block * block);
    }
  return out;
}

Result<BtfDifference> compareBtfs(const BtfSource& reference, const BtfSource& test,
                                  const CompareOptions& options) {
  if (const Status status = checkComparable(reference, test, options.level); !status) return status.issue();
  const size_t count = (reference.views().size() + options.every - 1) / options.every;
  std::vector<std::optional<ViewDifference>> views(count);
  std::vector<std::optional<Issue>> issues(count);  // the first view's is told, whichever thread was first
  Progress progress("compare", count, options.quiet);
  parallelFor(count, options.threads, [&](size_t i) {
    auto difference = compareView(reference, test, options, static_cast<int>(i) * options.every);
    if (difference)
      views[i] = std::move(*difference);
    else
      issues[i] = difference.issue();
    progress.advance();
  });
  for (const auto& issue : issues)
    if (issue) return *issue;
  return merged(views, reference.views(), options.every);
}

Result<PictureDifference> comparePictures(const Picture& reference, const Picture& test) {
  if (reference.width != test.width || reference.height != test.height)
    return Issue{issue_id::kImage, Severity::kError, "",
                 "the pictures have " + extentText({reference.width, reference.height}) + " and " +
                     extentText({test.width, test.height}) + " pixels; they must be of one size"};
  std::vector<glm::vec3> a, b;
  for (const glm::vec4& pixel : reference.pixels) a.emplace_back(pixel);
  for (const glm::vec4& pixel : test.pixels) b.emplace_back(pixel);
  PictureDifference difference;
  difference.all.add(a, b);
  const FlipError error = flip(a, b, reference.width, reference.height);
  difference.flip_mean = error.mean;
  difference.flip_max = error.max;
  return difference;
}

}  // namespace loden::importer
