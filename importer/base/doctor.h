// Facts about this machine and this build.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace loden::importer {

// (name, value) pairs in reading order: versions of the linked libraries, processor, threads, memory.
std::vector<std::pair<std::string, std::string>> systemFacts();

}  // namespace loden::importer
