#include "importer/btf/finite_source.h"

#include <cstdio>

namespace loden::importer {
namespace {

class RepairedSource : public BtfSource {
 public:
  RepairedSource(std::unique_ptr<BtfSource> source, std::shared_ptr<RepairLog> log)
      : source_(std::move(source)), log_(std::move(log)) {}
  const std::string& name() const override { return source_->name(); }
  glm::ivec2 size() const override { return source_->size(); }
  const DirectionSet& lights() const override { return source_->lights(); }
  const DirectionSet& views() const override { return source_->views(); }

  Result<std::vector<glm::vec3>> view(int view) const override {
    auto values = source_->view(view);
    if (!values) return values;
    const MapShape shape{lights().size(), size().x, size().y, 3};
    static_assert(sizeof(glm::vec3) == 3 * sizeof(float));
    const NonFinite found = repairNonFinite({&values->data()->x, values->size() * 3}, shape);
    char part[32];
    std::snprintf(part, sizeof part, "view %04d", view);
    if (found.count > 0) log_->add(part, found.count, placeOf(found.first, shape, "light"));
    return values;
  }

 private:
  std::unique_ptr<BtfSource> source_;
  std::shared_ptr<RepairLog> log_;
};

}  // namespace

std::unique_ptr<BtfSource> repairedSource(std::unique_ptr<BtfSource> source, std::shared_ptr<RepairLog> log) {
  return std::make_unique<RepairedSource>(std::move(source), std::move(log));
}

}  // namespace loden::importer
