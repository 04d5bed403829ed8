// Finds and runs programs in the folder of this program. Code that needs OpenGL is never linked into this
// program, but can be run in this way.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace loden::importer {

// The executable of that name in this executable's folder; empty if there is none.
std::filesystem::path siblingProgram(const std::string& name);

// Runs the program in place of this process, with the signal handling of a new process. Returns only if that
// fails.
void becomeProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments);

}  // namespace loden::importer
