#include "importer/gltf/gltf_resource.h"

#include <fstream>

#include "importer/gltf/gltf_document.h"
#include "material/base/check.h"
#include "material/base/issues.h"
#include "material/system/confined_path.h"

namespace loden::importer {

namespace fs = std::filesystem;

GltfResource GltfResource::of(std::string bytes) {
  GltfResource resource;
  resource.size_ = bytes.size();
  resource.bytes_ = std::move(bytes);
  return resource;
}

Result<GltfResource> GltfResource::open(const std::string& uri, const fs::path& folder,
                                        const std::string& where) {
  if (isDataUri(uri)) {
    auto bytes = bytesOfDataUri(uri);
    if (!bytes)
      return Issue{issue_id::kDataUri, Severity::kError, where, "is a data uri of no base64, or damaged"};
    return of(std::move(*bytes));
  }
  const auto path = confinedPath(folder, uri, where);
  if (!path) return path.issue();
  GltfResource resource;
  resource.file_ = *path;
  std::error_code error;
  if (fs::is_regular_file(resource.file_, error))
    resource.size_ = fs::file_size(resource.file_, error);
  else
    error = std::make_error_code(std::errc::no_such_file_or_directory);
  if (error || !std::ifstream(resource.file_, std::ios::binary))
    return Issue{issue_id::kCannotOpen, Severity::kError, where,
                 "'" + uri + "' is not there, or not readable"};
  return resource;
}

Result<std::string> GltfResource::read(uint64_t offset, uint64_t length) const {
  LODEN_CHECK_LE(offset, size_);
  LODEN_CHECK_LE(length, size_ - offset);
  if (file_.empty()) return bytes_.substr(offset, length);
  std::ifstream file(file_, std::ios::binary);
  std::string bytes(length, '\0');
  if (!file.seekg(static_cast<std::streamoff>(offset)) ||
      !file.read(bytes.data(), static_cast<std::streamsize>(length)))
    return Issue{issue_id::kCannotRead, Severity::kError, file_.string(), "cannot be read"};
  return bytes;
}

}  // namespace loden::importer
