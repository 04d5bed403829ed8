// What a uri of a glTF document, or its binary chunk, stands for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "material/base/result.h"

namespace loden::importer {

class GltfResource {
 public:
  // Of a data uri or of a file that stays in `folder`. Files are opened, not read: kGltfPath, kCannotOpen; a
  // data uri that is no base64 is kGltfParse.
  static Result<GltfResource> open(const std::string& uri, const std::filesystem::path& folder,
                                   const std::string& where);
  static GltfResource of(std::string bytes);

  uint64_t size() const { return size_; }
  // `length` bytes from `offset` on; they must lie within size(). kCannotRead.
  Result<std::string> read(uint64_t offset, uint64_t length) const;

 private:
  std::string bytes_;           // of what is no file
  std::filesystem::path file_;  // or empty
  uint64_t size_ = 0;
};

}  // namespace loden::importer
