// GLSL on the CPU: its types and functions by the names that the shader library uses, in double. The text of
// shaders/loden_*.glsl is included into a class as it stands (vdim_lookup.cpp), between glsl_begin.h and
// glsl_end.h, so that the evaluator and the GPU run one source. For that the text fills structs by
// initializer lists or member by member, reads swizzles but does not write to them, and has no out
// parameters.
#pragma once

#include <concepts>
#include <glm/glm.hpp>

namespace loden::glsl {

// GLM's vectors, with the swizzles that the text reads.
struct vec2 : glm::dvec2 {
  using glm::dvec2::vec;
  constexpr vec2(const glm::dvec2& v) : glm::dvec2(v) {}
  constexpr vec2 xy_() const { return *this; }
  constexpr vec2 yx_() const { return {y, x}; }
};

struct vec3 : glm::dvec3 {
  using glm::dvec3::vec;
  constexpr vec3(const glm::dvec3& v) : glm::dvec3(v) {}
  constexpr vec2 xy_() const { return {x, y}; }
};

struct vec4 : glm::dvec4 {
  using glm::dvec4::vec;
  constexpr vec4(const glm::dvec4& v) : glm::dvec4(v) {}
  constexpr vec2 xy_() const { return {x, y}; }
  constexpr vec4 wzxy_() const { return {w, z, x, y}; }
};

using mat2 = glm::dmat2;
using glm::ivec2, glm::ivec3, glm::uvec4;

using glm::abs, glm::acos, glm::atan, glm::ceil, glm::clamp, glm::dot, glm::exp2, glm::floor, glm::fract,
    glm::greaterThanEqual, glm::lessThan, glm::log, glm::max, glm::min, glm::mix, glm::sign, glm::sqrt;

// Where all arguments are vectors of this file GLM would take them for scalars.
template <class V>
concept Vector = std::same_as<V, vec2> || std::same_as<V, vec3> || std::same_as<V, vec4>;
template <Vector V>
using Base = glm::vec<V::length(), double>;
template <Vector V>
Base<V> abs(V a) {
  return glm::abs(Base<V>(a));
}
template <Vector V>
Base<V> floor(V a) {
  return glm::floor(Base<V>(a));
}
template <Vector V>
Base<V> min(V a, V b) {
  return glm::min(Base<V>(a), Base<V>(b));
}
template <Vector V>
Base<V> max(V a, V b) {
  return glm::max(Base<V>(a), Base<V>(b));
}
template <Vector V>
Base<V> clamp(V a, V low, V high) {
  return glm::clamp(Base<V>(a), Base<V>(low), Base<V>(high));
}
template <Vector V>
double dot(V a, V b) {
  return glm::dot(Base<V>(a), Base<V>(b));
}
template <Vector V, class Which>
Base<V> mix(V a, V b, Which which) {
  return glm::mix(Base<V>(a), Base<V>(b), which);
}

}  // namespace loden::glsl
