// How deep a JSON text nests, found before a parser that recurses sees it (a stack holds about 20 000
// levels).
#pragma once

#include <string>
#include <string_view>

#include "material/base/result.h"

namespace loden {

inline constexpr int kMaxJsonDepth = 64;  // nested arrays and objects

// OK if arrays and objects nest at most kMaxJsonDepth deep outside of strings; kGltfDepth otherwise. The text
// need not be valid JSON.
Status checkJsonDepth(std::string_view json, const std::string& name);

}  // namespace loden
