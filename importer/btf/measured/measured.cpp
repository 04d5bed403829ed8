#include "importer/btf/measured/measured.h"

#include "importer/base/file_read.h"
#include "importer/btf/measured/bonn_folder.h"
#include "importer/btf/measured/btf_file.h"
#include "material/base/issues.h"

namespace loden::importer {

Result<std::unique_ptr<MeasuredSource>> openMeasured(const std::filesystem::path& path) {
  std::error_code error;
  if (Status status = checkOpens(path, Openable::kFileOrFolder); !status) return status.issue();
  if (!std::filesystem::is_directory(path, error)) return openBtfFile(path);
  if (looksLikeBonnFolder(path)) return openBonnFolder(path);
  return Issue{
      issue_id::kMeasured, Severity::kError, path.string(),
      "is neither a finished bake (no bake.json) nor a Bonn image folder (no image named by tl, pl, tv, pv)"};
}

}  // namespace loden::importer
