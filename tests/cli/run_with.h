// Runs `loden` where calls on files fail, or until it is killed.
#pragma once

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "tests/cli/loden_fixture.h"

namespace loden::test {

inline std::string quoted(const std::string& word) {
  return std::string("'").append(word).append("'");
}

// Runs `loden` from a shell, after the command `before`, which sets variables and limits.
inline ToolRun lodenFromShell(const std::string& before, const std::vector<std::string>& arguments) {
  std::string command = before + " " + quoted(LODEN_TOOL);
  for (const std::string& argument : arguments) command.append(" ").append(quoted(argument));
  return runTool("/bin/sh", {"-c", command});
}

// The files below a folder, by their names relative to it.
inline std::vector<std::string> namesIn(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (!entry.is_directory()) names.push_back(std::filesystem::relative(entry.path(), folder).string());
  std::sort(names.begin(), names.end());
  return names;
}

// The bytes of each file below a folder, by its name relative to the folder.
inline std::map<std::string, std::string> filesIn(const std::filesystem::path& folder) {
  std::map<std::string, std::string> files;
  for (const std::string& name : namesIn(folder)) files[name] = fileText(folder / name);
  return files;
}

// Whether the name is that of a temporary file. A writer that is killed leaves one behind; the next writer of
// the same file removes it.
inline bool isTemporary(const std::string& name) {
  return name.find(".loden-") != std::string::npos || name.find("tmp") != std::string::npos;
}

// Arguments of a bake that takes a second at most; so do cooks of what it bakes.
inline std::vector<std::string> smallBake(const std::filesystem::path& folder,
                                          const std::vector<std::string>& more = {}) {
  std::vector<std::string> arguments{"bake", "builtin:button", "-o",  folder.string(), "--size",
                                     "8",    "--directions",   "3x3", "--supersample", "1",
                                     "-q"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

}  // namespace loden::test
