// Programs that stand beside this one: what links OpenGL is never linked here, but may be run.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace loden::importer {

// The executable of that name in this executable's folder; empty if it is not there.
std::filesystem::path siblingProgram(const std::string& name);

// Runs it in place of this process, with the signals a new process has. Comes back only if that fails.
void becomeProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments);

}  // namespace loden::importer
