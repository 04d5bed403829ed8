#include "material/system/confined_path.h"

#include <optional>

#include "material/base/issues.h"

namespace loden {
namespace {

namespace fs = std::filesystem;

int hexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

// Nothing if an escape is broken or hides a zero byte.
std::optional<std::string> percentDecoded(std::string_view uri) {
  std::string text;
  for (size_t i = 0; i < uri.size(); ++i) {
    char c = uri[i];
    if (c == '%') {
      if (uri.size() - i < 3) return {};
      const int high = hexDigit(uri[i + 1]), low = hexDigit(uri[i + 2]);
      if (high < 0 || low < 0) return {};
      c = static_cast<char>(high * 16 + low);
      i += 2;
    }
    if (c == '\0') return {};
    text += c;
  }
  return text;
}

Issue refusal(int id, std::string_view uri, const std::string& where, const std::string& why) {
  return {id, Severity::kError, where, "uri \"" + std::string(uri.substr(0, 200)) + "\" " + why};
}

bool isInside(const fs::path& folder, const fs::path& path) {
  const fs::path relative = path.lexically_relative(folder);
  return !relative.empty() && *relative.begin() != ".." && relative != ".";
}

}  // namespace

Result<fs::path> relativePathOfUri(std::string_view uri, const std::string& where) {
  const std::optional<std::string> text = percentDecoded(uri);
  if (!text || text->empty() || text->find('\\') != std::string::npos)
    return refusal(issue_id::kUriSyntax, uri, where, "is not a valid relative URI");
  const size_t colon = uri.find(':');
  const fs::path path = fs::path(*text).lexically_normal();
  if ((colon != std::string_view::npos && colon < uri.find('/')) || path.is_absolute())
    return refusal(issue_id::kUriAbsolute, uri, where, "names no file beside the document: make it relative");
  if (path.empty() || *path.begin() == "..")
    return refusal(issue_id::kGltfPath, uri, where,
                   "leads outside the document's folder: move the file into it");
  return path;
}

Result<fs::path> confinedPath(const fs::path& folder, std::string_view uri, const std::string& where) {
  const auto relative = relativePathOfUri(uri, where);
  if (!relative) return relative.issue();
  std::error_code error;
  const fs::path base = fs::weakly_canonical(folder.empty() ? fs::path(".") : folder, error);
  if (error) return refusal(issue_id::kGltfPath, uri, where, "stands in a folder that cannot be resolved");
  const fs::path path = fs::weakly_canonical(base / *relative, error);
  if (error || !isInside(base, path))
    return refusal(issue_id::kGltfPath, uri, where,
                   "leads outside the document's folder: move the file into it");
  return path;
}

}  // namespace loden
