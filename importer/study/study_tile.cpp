#include "importer/study/study_tile.h"

namespace loden::importer {

Result<StudyTile> studyTile(const StudyOptions& options, const std::string& tile) {
  auto baked = studyBake(options, tile);
  if (!baked) return baked.issue();
  auto source = bakedSource(*baked);
  if (!source) return source.issue();
  auto btf = loadYcc(**source, options.threads);
  if (!btf) return btf.issue();
  return StudyTile{tile, std::move(*baked), std::move(*source), std::move(*btf)};
}

}  // namespace loden::importer
