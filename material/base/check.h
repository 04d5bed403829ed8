// Checks for programmer mistakes, active in every build: a check that fails prints both values and aborts.
#pragma once

#include <cstdio>
#include <cstdlib>
#include <sstream>
#include <string>

namespace loden::detail {

[[noreturn]] inline void checkFailed(const char* file, int line, const char* expression,
                                     const std::string& values) {
  std::fprintf(stderr, "%s:%d: check failed: %s%s\n", file, line, expression, values.c_str());
  std::abort();
}

template <class A, class B>
std::string bothValues(const A& a, const B& b) {
  std::ostringstream text;
  text << " (" << a << " against " << b << ")";
  return text.str();
}

}  // namespace loden::detail

#define LODEN_CHECK(condition)                                                          \
  do {                                                                                  \
    if (!(condition)) ::loden::detail::checkFailed(__FILE__, __LINE__, #condition, ""); \
  } while (0)

#define LODEN_CHECK_OP(a, op, b)                                          \
  do {                                                                    \
    if (!((a)op(b)))                                                      \
      ::loden::detail::checkFailed(__FILE__, __LINE__, #a " " #op " " #b, \
                                   ::loden::detail::bothValues(a, b));    \
  } while (0)

#define LODEN_CHECK_EQ(a, b) LODEN_CHECK_OP(a, ==, b)
#define LODEN_CHECK_LT(a, b) LODEN_CHECK_OP(a, <, b)
#define LODEN_CHECK_LE(a, b) LODEN_CHECK_OP(a, <=, b)
