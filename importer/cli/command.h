// What a verb of the `loden` tool is made of. CLI11, which is slow to compile, stays behind `Options`.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "material/base/exit_code.h"

namespace loden::importer {

// Options that every verb has.
struct GlobalOptions {
  bool json = false;
  int threads = 0;  // 0: all
  bool quiet = false;
  bool verbose = false;
  std::string command_line;  // as typed, for reports
};

// Options of one verb while it declares them. Every variable must outlive the parse; its value is the default
// that `--help` shows. `names` as in "-o,--output"; without a dash it is positional.
class Options {
 public:
  struct Impl;
  explicit Options(Impl& impl) : impl_(impl) {}

  void text(const std::string& names, std::string& value, const std::string& help, bool required = false);
  void path(const std::string& names, std::filesystem::path& value, const std::string& help,
            bool required = false);
  void paths(const std::string& names, std::vector<std::filesystem::path>& value, const std::string& help);
  void integer(const std::string& names, int& value, const std::string& help, int least, int most);
  void bytes(const std::string& names, uint64_t& value, const std::string& help);  // "614400", "600k", "1.5M"
  void number(const std::string& names, double& value, const std::string& help,
              bool infinite = false);  // never NaN
  void flag(const std::string& names, bool& value, const std::string& help);
  // One of the given words.
  void choice(const std::string& names, std::string& value, const std::vector<std::string>& words,
              const std::string& help, bool required = false);
  // Commas between, or the option several times.
  void texts(const std::string& names, std::vector<std::string>& value, const std::string& help);
  // Shown under the options.
  void footer(const std::string& text);

 private:
  Impl& impl_;
};

class Command {
 public:
  virtual ~Command() = default;
  virtual std::string_view name() const = 0;
  virtual std::string_view summary() const = 0;  // one line, for the list of verbs
  virtual void declare(Options& options) = 0;
  virtual int run(const GlobalOptions& globals) = 0;  // returns an ExitCode
};

// Parses, runs the verb, and returns the process's exit code. Usage errors are explained on stderr.
int runCommandLine(int argc, char** argv, const std::vector<std::unique_ptr<Command>>& commands);

std::unique_ptr<Command> makeBakeCommand();
std::unique_ptr<Command> makeCookCommand();
std::unique_ptr<Command> makeInfoCommand();
std::unique_ptr<Command> makeValidateCommand();
std::unique_ptr<Command> makeExtractCommand();
std::unique_ptr<Command> makeCompareCommand();
std::unique_ptr<Command> makePackCommand();
std::unique_ptr<Command> makeTraceCommand();
std::unique_ptr<Command> makeStudyCommand();
std::unique_ptr<Command> makeDoctorCommand();

}  // namespace loden::importer
