// The shader library's files as text.
#pragma once

#include <span>
#include <string_view>

namespace loden {

struct ShaderSource {
  std::string_view name;  // file name: "loden_material.glsl"
  std::string_view text;
};
std::span<const ShaderSource> shaderSources();
// Text of one file; empty if there is none of this name.
std::string_view shaderSource(std::string_view name);

}  // namespace loden
