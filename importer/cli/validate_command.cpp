// loden validate X
#include <algorithm>
#include <nlohmann/json.hpp>

#include "importer/base/file_read.h"
#include "importer/cli/input_kind.h"
#include "importer/cli/output.h"
#include "importer/gltf/pack.h"
#include "importer/gltf/validate.h"
#include "material/base/issue_table.h"
#include "material/base/issues.h"

namespace loden::importer {
namespace {

class ValidateCommand : public Command {
 public:
  std::string_view name() const override { return "validate"; }
  std::string_view summary() const override {
    return "Check an asset or a packed scene; numbered issues, exit code 3 if invalid";
  }

  void declare(Options& options) override {
    options.path("file", path_, "Asset (.loden) or scene (.gltf, .glb)");
    options.flag("--list", list_,
                 "Print the number, name and meaning of every issue that this finds instead");
    options.footer("Numbers: 1xxx files, 2xxx container, 3xxx header, 4xxx bands and maps, 5xxx glTF.");
  }

  int run(const GlobalOptions& globals) override {
    if (list_) return printList(globals);
    if (path_.empty()) return failUsage("file is required");
    const auto found = inputKind(path_) == InputKind::kGltf ? validateGltf(path_) : validateAssetFile();
    if (!found) return fail(found.issue());
    const std::vector<Issue>& issues = *found;
    const auto count = [&](Severity severity) {
      return std::count_if(issues.begin(), issues.end(),
                           [&](const Issue& issue) { return issue.severity == severity; });
    };
    const auto errors = count(Severity::kError), warnings = count(Severity::kWarning);
    if (globals.json) {
      nlohmann::ordered_json list = nlohmann::ordered_json::array();
      for (const Issue& issue : issues) list.push_back(issueJson(issue));
      printJson("validate", {{"file", path_.string()},
                             {"valid", errors == 0},
                             {"prefix", isPrefix(issues)},
                             {"errors", errors},
                             {"warnings", warnings},
                             {"issues", list}});
    } else {
      std::string text;
      for (const Issue& issue : issues) text += issueText(issue) + "\n";
      printText(text + formatted("%s: %s, %td errors, %td warnings\n", path_.c_str(),
                                 errors             ? "invalid"
                                 : isPrefix(issues) ? "valid prefix"
                                                    : "valid",
                                 errors, warnings));
    }
    return exitCodeOfAll(issues);
  }

 private:
  static int printList(const GlobalOptions& globals) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    std::string text;
    for (const IssueKind& kind : kIssueKinds) {
      if (kind.found_by != FoundBy::kValidate) continue;
      const std::string name(kind.name), summary(kind.summary);
      list.push_back({{"id", kind.id}, {"name", name}, {"summary", summary}});
      text += formatted("%d %-20s %s\n", kind.id, name.c_str(), summary.c_str());
    }
    if (globals.json)
      printJson("validate-list", {{"issues", list}});
    else
      printText(text);
    return kExitOk;
  }

  static bool isPrefix(const std::vector<Issue>& issues) {
    return std::any_of(issues.begin(), issues.end(),
                       [](const Issue& issue) { return issue.id == issue_id::kPrefix; });
  }

  Result<std::vector<Issue>> validateAssetFile() const {
    const auto bytes = readFile(path_);
    if (!bytes) return bytes.issue();
    return validateAssetBytes(std::as_bytes(std::span(*bytes)), path_.string());
  }

  std::filesystem::path path_;
  bool list_ = false;
};

}  // namespace

std::unique_ptr<Command> makeValidateCommand() {
  return std::make_unique<ValidateCommand>();
}

}  // namespace loden::importer
