// Limits how deeply a JSON text nests, before a recursive parser reads it (a stack holds about 20 000
// levels).
#pragma once

#include <string>
#include <string_view>

#include "material/base/result.h"

namespace loden {

inline constexpr int kMaxJsonDepth = 64;  // most levels of nested arrays and objects

// Success if arrays and objects, outside of strings, nest at most kMaxJsonDepth deep; kGltfDepth otherwise.
// The text need not be valid JSON.
Status checkJsonDepth(std::string_view json, const std::string& name);

}  // namespace loden
