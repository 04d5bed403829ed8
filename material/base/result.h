// Result: a value, or the Issue that explains why there is none. Bad files and wrong user input are reported
// in this way; programmer mistakes abort by LODEN_CHECK. No exception leaves a module.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "material/base/check.h"

namespace loden {

enum class Severity { kNote, kWarning, kError };

// A fault with its number. Numbers are stable: 1xxx I/O, 2xxx container, 3xxx header, 4xxx band and map data,
// 5xxx glTF, 6xxx bake and cook input, 7xxx GPU and memory. material/base/issues.h lists all of them.
struct Issue {
  int id = 0;
  Severity severity = Severity::kError;
  std::string where;  // file, and the place in it: "cloth.loden: chunk 3 (BAND)"
  std::string text;   // what is wrong and what to do about it
};

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      // NOLINT: a value is a result
  Result(Issue issue) : state_(std::move(issue)) {}  // NOLINT: so is an issue

  bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  T& value() & { return checked(), std::get<0>(state_); }
  const T& value() const& { return checked(), std::get<0>(state_); }
  T&& value() && { return checked(), std::get<0>(std::move(state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  const Issue& issue() const {
    LODEN_CHECK(!ok());
    return std::get<1>(state_);
  }

 private:
  void checked() const {
    if (!ok()) detail::checkFailed(__FILE__, __LINE__, "Result has a value", ": " + std::get<1>(state_).text);
  }
  std::variant<T, Issue> state_;
};

// Success, or the Issue that explains the failure.
class [[nodiscard]] Status {
 public:
  Status() = default;
  Status(Issue issue) : issue_(std::move(issue)) {}  // NOLINT
  bool ok() const { return !issue_; }
  explicit operator bool() const { return ok(); }
  const Issue& issue() const {
    LODEN_CHECK(!ok());
    return *issue_;
  }

 private:
  std::optional<Issue> issue_;
};

}  // namespace loden
