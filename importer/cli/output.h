// What verbs print: data on stdout as JSON or text, messages on stderr.
#pragma once

#include <filesystem>
#include <glm/glm.hpp>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "importer/cli/command.h"

namespace loden::importer {

class RepairLog;

// "file: place: what; remedy" on stderr; returns the exit code that goes with it.
int fail(const Issue& issue);
// Of what was found in a file: kExitInvalid if there is an error, kExitRuntime if that is want of memory,
// which says nothing about the file.
int exitCodeOfAll(std::span<const Issue> issues);
int failUsage(const std::string& text);
// A note on stderr, unless quiet.
void note(const GlobalOptions& globals, const std::string& text);
// The same for each of them: what a tile's file holds and a bake does not show.
void noteWarnings(const GlobalOptions& globals, std::span<const Issue> warnings);
// A note of what --fix-nonfinite repaired, if anything; null: the option was not given.
void noteRepairs(const GlobalOptions& globals, const RepairLog* repairs);
nlohmann::ordered_json repairsJson(const RepairLog* repairs);

// JSON on stdout with "schema": "loden/<verb>/1" in front.
void printJson(const std::string& verb, const nlohmann::ordered_json& fields);
void printText(const std::string& text);

// "1,836,784".
std::string withThousands(uint64_t number);
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

nlohmann::ordered_json issueJson(const Issue& issue);
std::string issueText(const Issue& issue);

// "15,30" in degrees (theta, phi) -> unit direction, above the horizon or anywhere; else an issue that names
// `option`.
enum class DirectionRange { kHemisphere, kSphere };
Result<glm::dvec3> parseDirection(const std::string& option, const std::string& text,
                                  DirectionRange range = DirectionRange::kHemisphere);
// "800x600".
Result<glm::ivec2> parseExtent(const std::string& option, const std::string& text);
// "8,2,2".
Result<std::vector<double>> parseNumbers(const std::string& option, const std::string& text, size_t count);

// Metres of "2cm", "15mm" or "0.3m".
Result<double> parseLength(const std::string& option, const std::string& text);

// Writes a whole text or binary file under a temporary name, then renames it.
Status writeWholeFile(const std::filesystem::path& path, std::string_view bytes);

}  // namespace loden::importer
