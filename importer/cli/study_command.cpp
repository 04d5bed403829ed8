// loden study NAME --json F
#include <algorithm>

#include "importer/cli/output.h"
#include "importer/cli/sibling_program.h"
#include "importer/study/study.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

// Needs OpenGL, which nothing here may link: a program of its own, beside this one.
constexpr const char* kTimeError = "time-error";
constexpr const char* kTimeErrorProgram = "bench_time_error";
constexpr int kTimeErrorMostSize = 256;

class StudyCommand : public Command {
 public:
  std::string_view name() const override { return "study"; }
  std::string_view summary() const override { return "Measure: the papers' tables and ours"; }

  void declare(Options& options) override {
    std::vector<std::string> names;
    std::string list;
    const auto add = [&](std::string_view name, std::string_view summary) {
      names.emplace_back(name);
      list += "  " + std::string(name) + std::string(24 - std::min<size_t>(23, name.size()), ' ') +
              std::string(summary) + "\n";
    };
    for (const Study& study : studies()) add(study.name, study.summary);
    add(kTimeError, "run time against error, beside what engines draw now (runs bench_time_error)");
    options.choice("name", study_, names, "Which study", true);
    options.texts("--tile", tiles_, "Tiles; default: button, isba, pulli, sponge");
    options.integer("--size", study_options_.size, "Reference texels per side", 4, 1024);
    options.integer("--every", study_options_.every,
                    "flat-reconstruction: the paper's protocol by every N-th view only; for large sizes", 1,
                    81);
    options.path("--json", json_, "Write the rows as JSON to this file");
    options.path("--csv", csv_, "Write the rows as CSV to this file");
    options.path("--bakes", study_options_.bakes,
                 "Folder of baked outputs, <tile>-<size>; baked there if missing");
    options.path("--pictures", study_options_.pictures,
                 "Write pictures into this folder, if the study has some");
    options.footer(
        "Studies:\n" + list +
        "Y, Cb and Cr are BT.601 of linear RGB, Lab is CIE76 under D65; 1 is white Lambert lit from above.\n"
        "FBTF: Flat Bidirectional Texture Functions. LBTF: Level-of-Detail Representation of BTFs.");
  }

  int run(const GlobalOptions& globals) override {
    if (!tiles_.empty()) study_options_.tiles = tiles_;
    study_options_.threads = globals.threads;
    study_options_.quiet = globals.quiet;
    const Study* const study = findStudy(study_);
    if (study_options_.every > 1 && !(study && study->takes_every))
      return fail({issue_id::kOption, Severity::kError, "--every",
                   "study " + study_ + " needs all views; leave --every out"});
    if (!study) return runTimeError(globals);
    const auto rows = study->run(study_options_);
    if (!rows) return fail(rows.issue());
    const std::string json = studyJson(*study, globals.command_line, *rows);
    if (!json_.empty())
      if (const Status status = writeWholeFile(json_, json); !status) return fail(status.issue());
    if (!csv_.empty())
      if (const Status status = writeWholeFile(csv_, studyCsv(*rows)); !status) return fail(status.issue());
    printText(globals.json ? json : studyTable(*rows));
    return kExitOk;
  }

 private:
  int runTimeError(const GlobalOptions& globals) const {
    if (study_options_.size > kTimeErrorMostSize)
      return fail({issue_id::kOption, Severity::kError, "--size",
                   "study time-error takes " + std::to_string(kTimeErrorMostSize) +
                       " at most: it draws the whole BTF, too"});
    const auto program = siblingProgram(kTimeErrorProgram);
    if (program.empty()) {
      failUsage(std::string(kTimeErrorProgram) +
                " is not beside loden; build that target, or ./loden.sh build, and run loden from there");
      return kExitUnsupported;
    }
    std::vector<std::string> arguments{
        "--size",    std::to_string(study_options_.size), "--bakes",  study_options_.bakes.string(),
        "--threads", std::to_string(globals.threads),     "--format", globals.json ? "json" : "text"};
    for (const std::string& tile : study_options_.tiles) arguments.insert(arguments.end(), {"--tile", tile});
    if (!json_.empty()) arguments.insert(arguments.end(), {"--json", json_.string()});
    if (!csv_.empty()) arguments.insert(arguments.end(), {"--csv", csv_.string()});
    arguments.insert(arguments.end(), {"--command", globals.command_line});
    if (globals.quiet) arguments.push_back("-q");
    becomeProgram(program, arguments);
    return fail({issue_id::kCannotOpen, Severity::kError, program.string(), "cannot be run"});
  }

  std::string study_;
  std::vector<std::string> tiles_;
  std::filesystem::path json_, csv_;
  StudyOptions study_options_;
};

}  // namespace

std::unique_ptr<Command> makeStudyCommand() {
  return std::make_unique<StudyCommand>();
}

}  // namespace loden::importer
