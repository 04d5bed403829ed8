#include <algorithm>
#include <memory>

#include "importer/gltf/validate.h"
#include "material/asset/asset.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

// Bytes that the caller keeps.
class BorrowedSource final : public ByteSource {
 public:
  explicit BorrowedSource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  uint64_t size() const override { return bytes_.size(); }
  Status read(uint64_t offset, std::span<std::byte> into) const override {
    LODEN_CHECK(offset <= bytes_.size() && into.size() <= bytes_.size() - offset);
    std::copy_n(bytes_.begin() + static_cast<ptrdiff_t>(offset), into.size(), into.begin());
    return {};
  }

 private:
  std::span<const std::byte> bytes_;
};

}  // namespace

std::vector<Issue> validateAssetBytes(std::span<const std::byte> bytes, const std::string& name) {
  std::vector<Issue> issues = validateAsset(bytes, name);
  if (!issues.empty()) return issues;
  const auto file = AssetFile::open(std::make_shared<BorrowedSource>(bytes), name);
  const size_t chunks = file ? file->chunks().size() : 0, present = file ? size_t(file->presentChunks()) : 0;
  if (present < chunks)
    issues.push_back({issue_id::kPrefix, Severity::kWarning, name,
                      "is a prefix: " + std::to_string(present) + " of " + std::to_string(chunks) +
                          " chunks are there, and the material is coarser than the whole"});
  return issues;
}

}  // namespace loden::importer
