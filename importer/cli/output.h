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

// Prints "file: place: what; remedy" on stderr, and returns the issue's exit code.
int fail(const Issue& issue);
// The exit code for the issues found in a file: kExitInvalid if there is an error, but kExitRuntime if the
// error is too little memory, which says nothing about the file.
int exitCodeOfAll(std::span<const Issue> issues);
int failUsage(const std::string& text);
// Prints a note on stderr, unless quiet.
void note(const GlobalOptions& globals, const std::string& text);
// Prints each warning as a note: the things in a tile's file that a bake does not show.
void noteWarnings(const GlobalOptions& globals, std::span<const Issue> warnings);
// Prints a note about what --fix-nonfinite repaired, if anything; null: the option was not given.
void noteRepairs(const GlobalOptions& globals, const RepairLog* repairs);
nlohmann::ordered_json repairsJson(const RepairLog* repairs);

// Prints JSON on stdout, with "schema": "loden/<verb>/1" as the first member.
void printJson(const std::string& verb, const nlohmann::ordered_json& fields);
void printText(const std::string& text);

// The number with thousands separators: "1,836,784".
std::string withThousands(uint64_t number);
std::string formatted(const char* format, ...) __attribute__((format(printf, 1, 2)));

nlohmann::ordered_json issueJson(const Issue& issue);
std::string issueText(const Issue& issue);

// The unit direction of a text such as "15,30" (theta and phi in degrees), above the horizon or anywhere. Its
// issue names `option`.
enum class DirectionRange { kHemisphere, kSphere };
Result<glm::dvec3> parseDirection(const std::string& option, const std::string& text,
                                  DirectionRange range = DirectionRange::kHemisphere);
// The extent in a text such as "800x600".
Result<glm::ivec2> parseExtent(const std::string& option, const std::string& text);
// The numbers in a text such as "8,2,2".
Result<std::vector<double>> parseNumbers(const std::string& option, const std::string& text, size_t count);

// The metres of a length such as "2cm", "15mm" or "0.3m".
Result<double> parseLength(const std::string& option, const std::string& text);

// Writes a whole text or binary file under a temporary name, then renames it.
Status writeWholeFile(const std::filesystem::path& path, std::string_view bytes);

}  // namespace loden::importer
