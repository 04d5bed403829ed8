#include "importer/btf/measured/btf_file.h"

#include "importer/btf/measured/btf_kinds.h"

namespace loden::importer {

Status btf::BtfFile::atEnd(const asset::ByteCursor& cursor) const {
  if (cursor.left() == 0) return {};
  return brokenFile(name_, "has " + std::to_string(cursor.left()) + " bytes behind its data");
}

Result<std::unique_ptr<MeasuredSource>> openBtfFile(const std::filesystem::path& path) {
  auto file = MappedFile::open(path);
  if (!file) return file.issue();
  const std::string name = path.string();
  asset::ByteCursor cursor((*file)->bytes());
  auto header = btf::readHeader(cursor, name);
  if (!header) return header.issue();
  switch (header->signature.kind) {
    case btf::Kind::kDfmf:
      return btf::openDfmf(std::move(*file), std::move(*header), cursor, name);
    case btf::Kind::kFmf:
      return btf::openFmf(std::move(*file), std::move(*header), cursor, name);
    case btf::Kind::kPvf:
      return btf::openPvf(std::move(*file), std::move(*header), cursor, name);
    case btf::Kind::kBdi:
      break;
  }
  return btf::openBdi(std::move(*file), std::move(*header), cursor, name);
}

}  // namespace loden::importer
