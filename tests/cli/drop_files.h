// Drops files onto a window of another program, as a file manager does (the XDND protocol, version 5).
#pragma once

#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

namespace loden::test {

// Drops the files onto the middle of the display's first window that takes drops, and waits until the window
// says that it has them, for `most` at most. Returns an empty text, or what went wrong.
std::string dropFiles(const char* display, const std::vector<std::filesystem::path>& files,
                      std::chrono::seconds most);

}  // namespace loden::test
