// What this machine and this build offer.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace loden::importer {

// (what, value): versions of the linked libraries, processor, threads, memory. In reading order.
std::vector<std::pair<std::string, std::string>> systemFacts();

}  // namespace loden::importer
