#include "importer/cli/output.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "importer/base/repair_log.h"
#include "importer/cli/interrupt.h"
#include "material/base/issues.h"
#include "material/model/directions.h"
#include "material/model/uv_survey.h"
#include "material/system/atomic_file.h"

namespace loden::importer {
namespace {

const char* severityName(Severity severity) {
  return severity == Severity::kError ? "error" : severity == Severity::kWarning ? "warning" : "note";
}

// "flat_size", a field of a library's options, as it is typed: "--flat-size". What is no name of a field
// stays.
std::string optionOfField(const std::string& field) {
  if (const size_t comma = field.find(", "); comma != std::string::npos)
    return optionOfField(field.substr(0, comma)) + ", " + optionOfField(field.substr(comma + 2));
  if (field.find_first_not_of("abcdefghijklmnopqrstuvwxyz_") != std::string::npos || field.empty())
    return field;
  if (field == "vdims") return "--vdim";
  std::string option = "--" + field;
  std::replace(option.begin(), option.end(), '_', '-');
  return option;
}

}  // namespace

std::string issueText(const Issue& issue) {
  return formatted("%s %d: ", severityName(issue.severity), issue.id) + issue.where +
         (issue.where.empty() ? "" : ": ") + issue.text;
}

int fail(const Issue& issue) {
  const bool option = issue.id == issue_id::kOption || issue.id == issue_id::kGoal;
  const std::string where = option ? optionOfField(issue.where) : issue.where;
  std::fprintf(stderr, "loden: %s%s%s [%d]\n", where.c_str(), where.empty() ? "" : ": ", issue.text.c_str(),
               issue.id);
  return exitCodeOf(issue);
}

int exitCodeOfAll(std::span<const Issue> issues) {
  int code = kExitOk;
  for (const Issue& issue : issues) {
    if (issue.id == issue_id::kMemory) return kExitRuntime;
    if (issue.id == issue_id::kCannotRead) return kExitIo;  // what is in the file is not known
    if (issue.severity == Severity::kError) code = kExitInvalid;
  }
  return code;
}

int failUsage(const std::string& text) {
  std::fprintf(stderr, "loden: %s\n", text.c_str());
  return kExitUsage;
}

void note(const GlobalOptions& globals, const std::string& text) {
  if (!globals.quiet) std::fprintf(stderr, "%s\n", text.c_str());
}

void noteWarnings(const GlobalOptions& globals, std::span<const Issue> warnings) {
  for (const Issue& warning : warnings) note(globals, issueText(warning));
}

void noteRepairs(const GlobalOptions& globals, const RepairLog* repairs) {
  if (repairs && repairs->count() > 0)
    note(globals,
         "repaired what was not finite: " + withThousands(repairs->count()) + ", first " + repairs->first());
}

nlohmann::ordered_json repairsJson(const RepairLog* repairs) {
  const uint64_t count = repairs ? repairs->count() : 0;
  return {{"count", count}, {"first", count > 0 ? repairs->first() : std::string()}};
}

void printJson(const std::string& verb, const nlohmann::ordered_json& fields) {
  nlohmann::ordered_json json{{"schema", "loden/" + verb + "/1"}};
  json.update(fields);
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;  // file names need not be UTF-8
  printText(json.dump(2, ' ', false, replace) + "\n");
}

void printText(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}

std::string withThousands(uint64_t number) {
  const std::string digits = std::to_string(number);
  std::string text;
  for (size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string formatted(const char* format, ...) {
  va_list arguments, again;
  va_start(arguments, format);
  va_copy(again, arguments);
  std::string text(static_cast<size_t>(std::max(0, std::vsnprintf(nullptr, 0, format, arguments))), '\0');
  std::vsnprintf(text.data(), text.size() + 1, format, again);
  va_end(again);
  va_end(arguments);
  return text;
}

nlohmann::ordered_json issueJson(const Issue& issue) {
  return {{"id", issue.id},
          {"severity", severityName(issue.severity)},
          {"where", issue.where},
          {"text", issue.text}};
}

namespace {

Issue badOption(const std::string& option, const std::string& text, const std::string& wanted) {
  return {issue_id::kOption, Severity::kError, option, "'" + text + "' is not " + wanted};
}

}  // namespace

Result<std::vector<double>> parseNumbers(const std::string& option, const std::string& text, size_t count) {
  std::vector<double> numbers;
  const char* at = text.c_str();
  while (*at) {
    char* end = nullptr;
    const double number = std::strtod(at, &end);
    if (end == at || !std::isfinite(number)) break;
    numbers.push_back(number);
    at = end;
    if (*at != ',') break;
    ++at;
  }
  if (*at || numbers.size() != count)
    return badOption(option, text,
                     count == 1 ? "a number" : std::to_string(count) + " numbers with commas between");
  return numbers;
}

Result<glm::dvec3> parseDirection(const std::string& option, const std::string& text, DirectionRange range) {
  const auto degrees = parseNumbers(option, text, 2);
  if (!degrees) return badOption(option, text, "THETA,PHI in degrees, for example 30,45");
  const double theta = (*degrees)[0], phi = (*degrees)[1];
  const bool hemisphere = range == DirectionRange::kHemisphere;
  if (theta < 0 || theta > 180 || (hemisphere && theta >= 90))
    return badOption(option, text,
                     hemisphere ? "above the horizon: theta runs from 0 to below 90 degrees"
                                : "a direction: theta runs from 0 to 180 degrees");
  return directionFromSpherical({theta * kPi / 180, phi * kPi / 180});
}

Result<glm::ivec2> parseExtent(const std::string& option, const std::string& text) {
  int width = 0, height = 0, used = 0;
  if (std::sscanf(text.c_str(), "%dx%d%n", &width, &height, &used) != 2 ||
      used != static_cast<int>(text.size()) || width < 1 || height < 1 || width > 16384 || height > 16384)
    return badOption(option, text, "WxH with sides 1 to 16384, for example 800x600");
  return glm::ivec2(width, height);
}

Result<double> parseLength(const std::string& option, const std::string& text) {
  if (const auto metres = lengthFromText(text.c_str())) return *metres;
  return badOption(option, text, "a length with its unit, as 2cm, 15mm or 0.3m");
}

Status writeWholeFile(const std::filesystem::path& path, std::string_view bytes) {
  const CommitScope commit;
  return writeFileAtomically(path, std::as_bytes(std::span(bytes)));
}

}  // namespace loden::importer
