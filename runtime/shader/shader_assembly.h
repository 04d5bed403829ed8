// GLSL source from the embedded files; no GL here.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "material/base/result.h"

namespace loden::runtime {

// A complete shader. `files` names the `#line` file numbers in it.
struct AssembledShader {
  std::string text;
  std::vector<std::string> files;
};

// `#version 450 core`, `defines` as `#define` lines, then `text` with each `#include "name"` line replaced by
// the embedded file of that name, at most once per file. kShader if there is no such file.
Result<AssembledShader> assembleShader(const std::string& name, std::string_view text,
                                       std::span<const std::string> defines);

// A compiler log with file numbers turned into names: "0:12(5): error" -> "loden_bands.glsl:12(5): error".
// Takes the forms of Mesa and AMD ("0:12") and of NVIDIA ("0(12)").
std::string namedShaderLog(std::string_view log, std::span<const std::string> files);

}  // namespace loden::runtime
