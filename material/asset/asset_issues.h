// Collects the issues of an asset. Internal to the container.
#pragma once

#include <exception>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "material/asset/asset.h"
#include "material/base/issues.h"
#include "material/base/result.h"

namespace loden::asset {

template <class... Values>
std::string join(const Values&... values) {
  std::ostringstream text;
  (text << ... << values);
  return text.str();
}

// The place of a chunk in messages: "chunk 3 (BAND)".
inline std::string chunkPlace(size_t index, uint32_t type) {
  return join("chunk ", index, " (", chunkName(type), ")");
}

class IssueList {
 public:
  explicit IssueList(std::string file) : file_(std::move(file)) {}

  bool empty() const { return issues_.empty(); }
  size_t size() const { return issues_.size(); }
  const Issue& first() const { return issues_.front(); }
  std::vector<Issue> take() { return std::move(issues_); }

  // The file's name and the place in it: "cloth.loden: chunk 3 (BAND)".
  std::string where(const std::string& place) const { return place.empty() ? file_ : file_ + ": " + place; }

  void add(int id, const std::string& place, std::string text) {
    issues_.push_back({id, Severity::kError, where(place), std::move(text)});
  }
  void add(Issue issue) { issues_.push_back(std::move(issue)); }
  // Adds the issue unless `holds`.
  template <class... Values>
  void require(bool holds, int id, const std::string& place, const Values&... text) {
    if (!holds) add(id, place, join(text...));
  }

 private:
  std::string file_;
  std::vector<Issue> issues_;
};

// The issue that there is not enough memory. It leaves the name out if there is no memory even for that.
inline Issue memoryIssue(const std::string& name, const char* why) noexcept {
  try {
    return {issue_id::kMemory, Severity::kError, name, join("not enough memory for this asset: ", why)};
  } catch (...) {
    // Neither string is long enough to be allocated.
    return {issue_id::kMemory, Severity::kError, "", "out of memory"};
  }
}

// Runs `work`, which returns a Result or a Status. An exception that it throws, such as std::bad_alloc,
// becomes an issue.
template <class Work>
auto withoutExceptions(const std::string& name, const Work& work) -> decltype(work()) {
  try {
    return work();
  } catch (const std::exception& exception) {
    return memoryIssue(name, exception.what());
  }
}

}  // namespace loden::asset
