// A tile in the form that studies of fits need.
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
  std::unique_ptr<BtfSource> source;  // source of `baked`
  YccBtf btf;                         // the whole BTF
};

// The output of studyBake, read whole. Issues: those of studyBake and of reading.
Result<StudyTile> studyTile(const StudyOptions& options, const std::string& tile);

}  // namespace loden::importer
