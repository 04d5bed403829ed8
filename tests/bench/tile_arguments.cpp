#include "tests/bench/tile_arguments.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "material/system/atomic_file.h"

namespace loden::bench {

namespace {

std::string program_name, program_usage;

[[noreturn]] void usage(const std::string& wrong) {
  std::fprintf(stderr, "%s: %s\nusage: %s\n", program_name.c_str(), wrong.c_str(), program_usage.c_str());
  std::exit(1);
}

// Whether the option is one of TileArguments with a value.
bool take(TileArguments& all, const std::string& option, const std::string& value) {
  if (option == "--tile")
    all.study.tiles = splitAtCommas(value);
  else if (option == "--lambda")
    all.lambdas = numbersOf(option, value, -8, 8);
  else if (option == "--only")
    all.only = splitAtCommas(value);
  else if (option == "--assets")
    all.assets = value;
  else if (option == "--pictures")
    all.pictures = value;
  else if (option == "--size")
    all.study.size = wholeNumberOf(option, value, 4, 256);
  else if (option == "--threads")
    all.study.threads = wholeNumberOf(option, value, 0, 1024);
  else if (option == "--bakes")
    all.study.bakes = value;
  else if (option == "--json")
    all.json = value;
  else if (option == "--csv")
    all.csv = value;
  else if (option == "--format" && (value == "text" || value == "json"))
    all.print_json = value == "json";
  else
    return false;
  return true;
}

void write(const std::string& path, const std::string& text) {
  if (path.empty()) return;
  if (const Status status = writeFileAtomically(path, std::as_bytes(std::span(text))); !status) {
    std::fprintf(stderr, "%s: %s\n", status.issue().where.c_str(), status.issue().text.c_str());
    std::exit(2);
  }
}

}  // namespace

bool TileArguments::wants(std::string_view renderer) const {
  return only.empty() || std::any_of(only.begin(), only.end(), [&](const std::string& part) {
           return renderer.find(part) != std::string_view::npos;
         });
}

TileArguments parseTileArguments(int argc, char** argv, const std::string& program,
                                 const std::string& usage_text, const OwnOptions& own) {
  program_name = program;
  program_usage = usage_text;
  TileArguments all;
  all.study.bakes = "out/studies/bakes";
  all.command = program;
  std::string command;
  for (int i = 1; i < argc; ++i) {
    const std::string option = argv[i];
    all.command += " " + option;
    if (option == "-q") {
      all.study.quiet = true;
      continue;
    }
    if (++i == argc) usage(option + " is unknown, or needs a value");
    const std::string value = argv[i];
    all.command += " " + value;
    const auto taker = own.find(option);
    if (option == "--command")
      command = value;
    else if (taker != own.end())
      taker->second(value);
    else if (!take(all, option, value))
      usage(option + " " + value + " is unknown");
  }
  if (!command.empty()) all.command = command;
  return all;
}

std::vector<double> numbersOf(const std::string& option, const std::string& text, double least, double most) {
  std::vector<double> values;
  for (const std::string& part : splitAtCommas(text)) {
    char* end = nullptr;
    values.push_back(std::strtod(part.c_str(), &end));
    if (part.empty() || *end != '\0' || !(values.back() >= least && values.back() <= most))
      usage(option + ": '" + part + "' is no number of " + std::to_string(least) + " to " +
            std::to_string(most));
  }
  return values;
}

int wholeNumberOf(const std::string& option, const std::string& text, int least, int most) {
  char* end = nullptr;
  const long value = std::strtol(text.c_str(), &end, 10);
  if (text.empty() || *end != '\0' || value < least || value > most)
    usage(option + ": '" + text + "' is not " + std::to_string(least) + " to " + std::to_string(most));
  return static_cast<int>(value);
}

std::vector<std::string> splitAtCommas(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',')
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

int reportRows(const TileArguments& arguments, const importer::Study& study, const std::string& heading,
               const importer::StudyRows& rows) {
  const std::string json = importer::studyJson(study, arguments.command, rows);
  write(arguments.json, json);
  write(arguments.csv, importer::studyCsv(rows));
  if (arguments.print_json)
    std::printf("%s", json.c_str());
  else
    std::printf("# %s\n%s", heading.c_str(), importer::studyTable(rows).c_str());
  return std::fflush(stdout) == 0 ? 0 : 2;
}

}  // namespace loden::bench
