// loden study NAME --json F
#include "importer/cli/output.h"
#include "importer/study/study.h"

namespace loden::importer {
namespace {

class StudyCommand : public Command {
 public:
  std::string_view name() const override { return "study"; }
  std::string_view summary() const override { return "Measure: the papers' tables and ours"; }

  void declare(Options& options) override {
    std::vector<std::string> names;
    std::string list;
    for (const Study& study : studies()) {
      names.emplace_back(study.name);
      list += "  " + std::string(study.name) + std::string(24 - std::min<size_t>(23, study.name.size()), ' ') +
              std::string(study.summary) + "\n";
    }
    options.choice("name", study_, names, "Which study", true);
    options.texts("--tile", tiles_, "Tiles; default: button, isba, pulli, sponge");
    options.integer("--size", study_options_.size, "Reference texels per side", 4, 1024);
    options.path("--json", json_, "Write the rows as JSON to this file");
    options.path("--csv", csv_, "Write the rows as CSV to this file");
    options.path("--bakes", study_options_.bakes, "Folder of baked outputs, <tile>-<size>; baked there if missing");
    options.path("--pictures", study_options_.pictures, "Write pictures into this folder");
    options.footer("Studies:\n" + list + "Y, Cb and Cr are BT.601 of linear RGB, Lab is CIE76 under D65; 1 is white Lambert lit from above.\n"
                   "FBTF: Flat Bidirectional Texture Functions. LBTF: Level-of-Detail Representation of BTFs.");
  }

  int run(const GlobalOptions& globals) override {
    if (!tiles_.empty()) study_options_.tiles = tiles_;
    study_options_.threads = globals.threads;
    study_options_.quiet = globals.quiet;
    const Study& study = *findStudy(study_);
    const auto rows = study.run(study_options_);
    if (!rows) return fail(rows.issue());
    const std::string json = studyJson(study, globals.command_line, *rows);
    if (!json_.empty())
      if (const Status status = writeWholeFile(json_, json); !status) return fail(status.issue());
    if (!csv_.empty())
      if (const Status status = writeWholeFile(csv_, studyCsv(*rows)); !status) return fail(status.issue());
    printText(globals.json ? json : studyTable(*rows));
    return kExitOk;
  }

 private:
  std::string study_;
  std::vector<std::string> tiles_;
  std::filesystem::path json_, csv_;
  StudyOptions study_options_;
};

}  // namespace

std::unique_ptr<Command> makeStudyCommand() { return std::make_unique<StudyCommand>(); }

}  // namespace loden::importer
