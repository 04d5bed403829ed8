// Studies: each turns tiles into rows of numbers, for the papers' tables and our own.
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

// One row: a flat object of the JSON. Keys keep their order.
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
  int every = 1;  // uses only the sampled views every / 2, every / 2 + every, ...
  // Folder of baked outputs, <tile>-<size>; missing ones are baked there.
  std::filesystem::path bakes = "out/bakes";
  std::filesystem::path pictures;  // folder for PNG pictures; empty: none
  int threads = 0;                 // 0: as many as there are cores
  bool quiet = false;
};

struct Study {
  std::string_view name;
  std::string_view summary;
  Result<StudyRows> (*run)(const StudyOptions& options);
  bool takes_every = false;  // the study supports StudyOptions::every
};

// All studies, in the order of the papers.
std::span<const Study> studies();
const Study* findStudy(std::string_view name);

// How a study needs a tile to be baked.
struct StudyBake {
  int flat_size = 0;  // texels per side of the Flat-BTF; 0: the study's size
  int supersample = 2;
  FillMethod fill = FillMethod::kPushPull;
  TexelMethod texels = TexelMethod::kMean;
  BakeMaps maps;            // the maps that are needed; there may be more
  bool some_views = false;  // only the views of StudyOptions::every are needed; others cannot be read
};

// The baked output of one tile at options.size and with all Bonn directions, in <bakes>/<tile>-<size>, to
// which -flat<size>, -s<samples>, -<texels>, -<fill> are appended where `bake` differs from the default. It
// is baked first if it is not there, or is of another tile.
Result<BakedOutput> studyBake(const StudyOptions& options, const std::string& tile,
                              const StudyBake& bake = {});
// The tile's name for loadTile: "button" becomes "builtin:button", and a path stays a path.
std::string studyTileName(const std::string& tile);

// The rows as JSON, {"schema":"loden/study/1","study":...,"command":...,"rows":[...]}; it ends with a
// newline.
std::string studyJson(const Study& study, const std::string& command, const StudyRows& rows);
// The rows as CSV: one header line of all keys in order of first use; quoting as in RFC 4180.
std::string studyCsv(const StudyRows& rows);
// The rows as text in aligned columns.
std::string studyTable(const StudyRows& rows);

// The entry points of the studies, in one source file each.
Result<StudyRows> studyFlatReconstruction(const StudyOptions& options);
Result<StudyRows> studyVdimInterpolation(const StudyOptions& options);
Result<StudyRows> studyCurvedLookup(const StudyOptions& options);
Result<StudyRows> studyViewCoherence(const StudyOptions& options);
Result<StudyRows> studyAbrdfSize(const StudyOptions& options);
Result<StudyRows> studyLodFit(const StudyOptions& options);
Result<StudyRows> studyMinification(const StudyOptions& options);
Result<StudyRows> studyLabBounds(const StudyOptions& options);

}  // namespace loden::importer
