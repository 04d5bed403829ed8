#include "material/base/json_depth.h"

#include "material/base/issues.h"

namespace loden {

Status checkJsonDepth(std::string_view json, const std::string& name) {
  int depth = 0;
  bool in_string = false;
  for (size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (in_string) {
      if (c == '\\')
        ++i;
      else if (c == '"')
        in_string = false;
      continue;
    }
    if (c == '"') in_string = true;
    if (c == ']' || c == '}') --depth;
    if ((c == '[' || c == '{') && ++depth > kMaxJsonDepth)
      return Issue{issue_id::kGltfDepth, Severity::kError, name + ": byte " + std::to_string(i),
                   "arrays and objects nest deeper than " + std::to_string(kMaxJsonDepth)};
  }
  return {};
}

}  // namespace loden
