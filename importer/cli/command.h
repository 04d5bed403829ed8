// The interface of a verb (command) of the `loden` tool. CLI11, which is slow to compile, is hidden behind
// `Options`.
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
  int threads = 0;  // 0: as many as there are cores
  bool quiet = false;
  bool verbose = false;
  std::string command_line;  // as typed, for reports
};

// The options of one verb, while it declares them. Every variable must outlive the parse; its value is the
// default that `--help` shows. `names` are as in "-o,--output"; a name without a dash is positional.
class Options {
 public:
  struct Impl;
  explicit Options(Impl& impl) : impl_(impl) {}

  void text(const std::string& names, std::string& value, const std::string& help, bool required = false);
  void path(const std::string& names, std::filesystem::path& value, const std::string& help,
            bool required = false);
  void paths(const std::string& names, std::vector<std::filesystem::path>& value, const std::string& help);
  void integer(const std::string& names, int& value, const std::string& help, int least, int most);
  // A number of bytes such as "614400", "600k" or "1.5M".
  void bytes(const std::string& names, uint64_t& value, const std::string& help);
  void number(const std::string& names, double& value, const std::string& help,
              bool infinite = false);  // never NaN
  void flag(const std::string& names, bool& value, const std::string& help);
  // An option whose value is one of the given words.
  void choice(const std::string& names, std::string& value, const std::vector<std::string>& words,
              const std::string& help, bool required = false);
  // An option with several values, separated by commas or given several times.
  void texts(const std::string& names, std::vector<std::string>& value, const std::string& help);
  // Sets the text shown below the options.
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

// Parses the command line, runs the verb, and returns the process's exit code. Usage errors are explained on
// stderr.
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
