// The papers' tables and ours: a study turns tiles into rows of numbers.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "importer/bake/bake.h"
#include "importer/btf/baked_output.h"
#include "material/base/result.h"

namespace loden::importer {

using StudyValue = std::variant<std::string, double, int64_t>;

// One flat object of the JSON; keys keep their order.
class StudyRow {
 public:
  StudyRow& set(std::string key, std::string value);
  StudyRow& set(std::string key, const char* value) { return set(std::move(key), std::string(value)); }
  StudyRow& set(std::string key, double value);
  StudyRow& set(std::string key, int value) { return set(std::move(key), int64_t{value}); }
  StudyRow& set(std::string key, int64_t value);
  StudyRow& set(std::string key, uint64_t value) { return set(std::move(key), static_cast<int64_t>(value)); }
  const std::vector<std::pair<std::string, StudyValue>>& cells() const { return cells_; }
  const StudyValue* find(std::string_view key) const;

 private:
  std::vector<std::pair<std::string, StudyValue>> cells_;
};
using StudyRows = std::vector<StudyRow>;

struct StudyOptions {
  std::vector<std::string> tiles{"button", "isba", "pulli", "sponge"};  // builtin names, or tile files
  int size = 64;                                                        // reference texels per side
  int every = 1;  // of sampled views those at every / 2, every / 2 + every, ... only
  std::filesystem::path bakes = "out/bakes";  // baked outputs, <tile>-<size>; baked there if missing
  std::filesystem::path pictures;             // PNG pictures go here; empty: none
  int threads = 0;                            // 0: all
  bool quiet = false;
};

struct Study {
  std::string_view name;
  std::string_view summary;
  Result<StudyRows> (*run)(const StudyOptions& options);
  bool takes_every = false;  // knows StudyOptions::every
};

// All studies, in the order of the papers.
std::span<const Study> studies();
const Study* findStudy(std::string_view name);

// How a study wants a tile baked.
struct StudyBake {
  int flat_size = 0;  // 0: as the study's size
  int supersample = 2;
  FillMethod fill = FillMethod::kPushPull;
  TexelMethod texels = TexelMethod::kMean;
  BakeMaps maps;            // at least
  bool some_views = false;  // only those of StudyOptions::every; the others are not there to be read
};

// The baked output of one tile at options.size and full Bonn directions: <bakes>/<tile>-<size>, and, where
// `bake` says otherwise than by default, -flat<size>, -s<samples>, -<texels>, -<fill>. Baked first if it is
// not there, or of another tile.
Result<BakedOutput> studyBake(const StudyOptions& options, const std::string& tile,
                              const StudyBake& bake = {});
// "button" -> "builtin:button"; a path stays a path.
std::string studyTileName(const std::string& tile);

// {"schema":"loden/study/1","study":...,"command":...,"rows":[...]}; ends with a newline.
std::string studyJson(const Study& study, const std::string& command, const StudyRows& rows);
// One header line of all keys in order of first use, RFC 4180 quoting.
std::string studyCsv(const StudyRows& rows);
// For people: aligned columns.
std::string studyTable(const StudyRows& rows);

// Entry points, one file each.
Result<StudyRows> studyFlatReconstruction(const StudyOptions& options);
Result<StudyRows> studyVdimInterpolation(const StudyOptions& options);
Result<StudyRows> studyCurvedLookup(const StudyOptions& options);
Result<StudyRows> studyViewCoherence(const StudyOptions& options);
Result<StudyRows> studyAbrdfSize(const StudyOptions& options);
Result<StudyRows> studyLodFit(const StudyOptions& options);
Result<StudyRows> studyMinification(const StudyOptions& options);
Result<StudyRows> studyLabBounds(const StudyOptions& options);

}  // namespace loden::importer
