// Drops files onto a window of another program, as a file manager does (the XDND protocol, version 5).
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace loden::test {

// Onto the middle of the first window of the display that takes drops; empty, or what went wrong. Returns
// when the window says that it has the files.
std::string dropFiles(const char* display, const std::vector<std::filesystem::path>& files,
                      std::chrono::seconds most);

}  // namespace loden::test
