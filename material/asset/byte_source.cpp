#include <algorithm>
#include <utility>

#include "material/asset/asset.h"
#include "material/base/issues.h"

namespace loden {
namespace {

class MemorySource final : public ByteSource {
 public:
  MemorySource(std::vector<std::byte> bytes, std::string name)
      : bytes_(std::move(bytes)), name_(std::move(name)) {}

  uint64_t size() const override { return bytes_.size(); }

  Status read(uint64_t offset, std::span<std::byte> into) const override {
    if (offset > bytes_.size() || into.size() > bytes_.size() - offset) {
      return Issue{issue_id::kCannotRead, Severity::kError, name_,
                   "cannot read at byte " + std::to_string(offset) + ": beyond the end"};
    }
    std::copy_n(bytes_.begin() + static_cast<ptrdiff_t>(offset), into.size(), into.begin());
    return {};
  }

 private:
  std::vector<std::byte> bytes_;
  std::string name_;
};

}  // namespace

std::unique_ptr<ByteSource> memorySource(std::vector<std::byte> bytes, std::string name) {
  return std::make_unique<MemorySource>(std::move(bytes), std::move(name));
}

}  // namespace loden
