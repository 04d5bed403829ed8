// The bytes that a URI of a glTF document, or its binary chunk, stands for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "material/base/result.h"

namespace loden::importer {

class GltfResource {
 public:
  // The resource of a data URI or of a file inside `folder`. Files are opened but not read. Issues:
  // kGltfPath, kCannotOpen; kGltfParse if a data URI is not valid base64.
  static Result<GltfResource> open(const std::string& uri, const std::filesystem::path& folder,
                                   const std::string& where);
  static GltfResource of(std::string bytes);

  uint64_t size() const { return size_; }
  // `length` bytes from `offset` on, which must lie within size(). Issues: kCannotRead.
  Result<std::string> read(uint64_t offset, uint64_t length) const;

 private:
  std::string bytes_;           // the bytes, if it is not a file
  std::filesystem::path file_;  // the file, or empty
  uint64_t size_ = 0;
};

}  // namespace loden::importer
