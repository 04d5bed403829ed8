#include <cstring>

#include "material/asset/asset.h"
#include "material/asset/asset_content.h"

namespace loden {
namespace {

using namespace asset;  // NOLINT: this file is the other half of it

// Bytes that the caller keeps.
class SpanSource final : public ByteSource {
 public:
  explicit SpanSource(std::span<const std::byte> bytes) : bytes_(bytes) {}
  uint64_t size() const override { return bytes_.size(); }
  Status read(uint64_t offset, std::span<std::byte> into) const override {
    LODEN_CHECK(offset <= bytes_.size() && into.size() <= bytes_.size() - offset);
    if (!into.empty()) std::memcpy(into.data(), bytes_.data() + offset, into.size());
    return {};
  }

 private:
  std::span<const std::byte> bytes_;
};

// What `work` adds to a list of issues; what it throws is one of them.
template <class Work>
std::vector<Issue> issuesOf(const std::string& name, const Work& work) {
  const auto collect = [&] {
    IssueList issues(name);
    const Status done = withoutExceptions(name, [&]() -> Status {
      work(issues);
      return {};
    });
    if (!done) issues.add(done.issue());
    return issues.take();
  };
  try {
    return collect();
  } catch (const std::exception& exception) {
    std::vector<Issue> one;
    one.push_back(memoryIssue(name, exception.what()));  // throws if there is no room for a list of one
    return one;
  }
}

}  // namespace

Result<Material> parseAsset(std::span<const std::byte> bytes, const std::string& name) {
  return readAsset(SpanSource(bytes), name);
}

Result<Material> readAsset(const ByteSource& source, const std::string& name) {
  return withoutExceptions(name, [&]() -> Result<Material> {
    IssueList issues(name);
    Material material = readAll(source, true, issues);
    if (!issues.empty()) return issues.first();
    return material;
  });
}

std::vector<Issue> validateAsset(std::span<const std::byte> bytes, const std::string& name) {
  return issuesOf(name, [&](IssueList& issues) { readAll(SpanSource(bytes), false, issues); });
}

std::vector<Issue> inspectAsset(const ByteSource& source, const std::string& name) {
  return issuesOf(name, [&](IssueList& issues) { inspectAll(source, issues); });
}

}  // namespace loden
