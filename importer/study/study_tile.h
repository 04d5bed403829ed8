// A tile as studies of fits take it.
#pragma once

#include <memory>
#include <string>

#include "importer/btf/btf_source.h"
#include "importer/fit/ycc_btf.h"
#include "importer/study/study.h"

namespace loden::importer {

struct StudyTile {
  std::string name;
  BakedOutput baked;
  std::unique_ptr<BtfSource> source;  // of it
  YccBtf btf;                         // all of it
};

// studyBake's output, read whole. Issues of studyBake and of reading.
Result<StudyTile> studyTile(const StudyOptions& options, const std::string& tile);

}  // namespace loden::importer
