#include "importer/btf/measured/cropped_source.h"

#include "material/base/issues.h"

namespace loden::importer {
namespace {

class CroppedSource : public BtfSource {
 public:
  CroppedSource(std::unique_ptr<BtfSource> source, int side)
      : source_(std::move(source)), side_(side), corner_((source_->size() - side) / 2) {}
  const std::string& name() const override { return source_->name(); }
  glm::ivec2 size() const override { return glm::ivec2(side_); }
  const DirectionSet& lights() const override { return source_->lights(); }
  const DirectionSet& views() const override { return source_->views(); }
  Result<std::vector<glm::vec3>> view(int view) const override {
    auto whole = source_->view(view);
    if (!whole) return whole;
    const auto width = static_cast<size_t>(source_->size().x), texels = width * size_t(source_->size().y);
    std::vector<glm::vec3> values;
    values.reserve(size_t(lights().size()) * size_t(side_) * size_t(side_));
    for (size_t light = 0; light < size_t(lights().size()); ++light)
      for (int j = 0; j < side_; ++j) {
        const auto row =
            whole->begin() +
            static_cast<std::ptrdiff_t>(light * texels + size_t(corner_.y + j) * width + size_t(corner_.x));
        values.insert(values.end(), row, row + side_);
      }
    return values;
  }

 private:
  std::unique_ptr<BtfSource> source_;
  int side_;
  glm::ivec2 corner_;
};

}  // namespace

Result<std::unique_ptr<BtfSource>> croppedSource(std::unique_ptr<BtfSource> source, int side) {
  const glm::ivec2 size = source->size();
  if (side > std::min(size.x, size.y))
    return Issue{issue_id::kOption, Severity::kError, "crop",
                 std::to_string(side) + " is more than " + source->name() + " has, " +
                     std::to_string(size.x) + " x " + std::to_string(size.y) + " texels"};
  return std::unique_ptr<BtfSource>(std::make_unique<CroppedSource>(std::move(source), side));
}

}  // namespace loden::importer
