// Assembles GLSL source from the files embedded in the library. Makes no GL call.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "material/base/result.h"

namespace loden::runtime {

// The complete text of a shader. `files[n]` is the name of the file that `#line` directives in the text call
// n.
struct AssembledShader {
  std::string text;
  std::vector<std::string> files;
};

// A complete shader: `#version 450 core`, then `defines` as `#define` lines, then `text`, in which each
// `#include "name"` line is replaced by the embedded file of that name, each file at most once. Issues:
// kShader if there is no such file.
Result<AssembledShader> assembleShader(const std::string& name, std::string_view text,
                                       std::span<const std::string> defines);

// The compiler log with file numbers replaced by names: "0:12(5): error" becomes "loden_bands.glsl:12(5):
// error". Understands the formats of Mesa and AMD ("0:12") and of NVIDIA ("0(12)").
std::string namedShaderLog(std::string_view log, std::span<const std::string> files);

}  // namespace loden::runtime
