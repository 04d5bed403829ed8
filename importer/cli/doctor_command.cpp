// loden doctor: this machine, the libraries, and, through loden_walk, the GPU. The importer itself never
// links GL.
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "importer/base/doctor.h"
#include "importer/cli/output.h"
#include "importer/cli/sibling_program.h"

extern char** environ;

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;

// Standard output of `program --doctor --format json`; empty if it cannot be run or fails.
std::string outputOf(const std::filesystem::path& program) {
  int ends[2];
  if (pipe(ends) != 0) return {};
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawn_file_actions_addclose(&actions, ends[0]);
  std::string name = program.string(), a = "--doctor", b = "--format", c = "json";
  char* arguments[] = {name.data(), a.data(), b.data(), c.data(), nullptr};
  pid_t child = 0;
  const int failed = posix_spawn(&child, name.c_str(), &actions, nullptr, arguments, environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  std::string text;
  char buffer[4096];
  for (ssize_t n = 0; !failed && (n = read(ends[0], buffer, sizeof buffer)) > 0;) text.append(buffer, n);
  close(ends[0]);
  int status = 1;
  if (!failed) waitpid(child, &status, 0);
  return !failed && status == 0 ? text : std::string();
}

std::string valueText(const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  return value.is_array() && value.empty() ? "nothing" : value.dump();
}

class DoctorCommand : public Command {
 public:
  std::string_view name() const override { return "doctor"; }
  std::string_view summary() const override {
    return "Show versions, limits, and what is missing on this machine";
  }
  void declare(Options&) override {}

  int run(const GlobalOptions& globals) override {
    const auto walk = siblingProgram("loden_walk");
    const Json gl = walk.empty() ? Json() : Json::parse(outputOf(walk), nullptr, false);
    std::vector<std::string> missing;
    if (walk.empty())
      missing.emplace_back("loden_walk is not beside loden: no OpenGL report; build the target loden_walk");
    else if (!gl.is_object())
      missing.emplace_back(
          "loden_walk --doctor gives no report: is there an OpenGL 4.5 driver (libgl1-mesa-dri, "
          "libegl-mesa0)?");
    if (globals.json) {
      Json json;
      for (const auto& [what, value] : systemFacts()) json["system"][what] = value;
      json["gl"] = gl.is_object() ? gl : Json();
      json["missing"] = missing;
      printJson("doctor", json);
      return kExitOk;
    }
    std::string text;
    for (const auto& [what, value] : systemFacts())
      text += formatted("%-24s %s\n", what.c_str(), value.c_str());
    if (gl.is_object())
      for (const auto& [key, value] : gl.items())
        if (key != "schema") text += formatted("%-24s %s\n", key.c_str(), valueText(value).c_str());
    for (const std::string& what : missing) text += "missing: " + what + "\n";
    printText(text);
    return kExitOk;
  }
};

}  // namespace

std::unique_ptr<Command> makeDoctorCommand() {
  return std::make_unique<DoctorCommand>();
}

}  // namespace loden::importer
