// Everything of the GL state that a caller may rely on, by name, for comparing before and after a call.
#pragma once

#include <map>
#include <string>
#include <vector>

namespace loden::test {

using GlState = std::map<std::string, std::vector<double>>;

GlState dumpGlState();
// Sets the state to values that are neither GL's defaults nor what the runtime would set. Makes a few
// objects, which stay until the context ends.
void disturbGlState();
// Names of entries that differ.
std::vector<std::string> differences(const GlState& a, const GlState& b);

}  // namespace loden::test
