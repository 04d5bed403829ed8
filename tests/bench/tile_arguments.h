// The command line that benchmarks of tiles share, and the tables that they print and write.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "importer/study/study.h"

namespace loden::bench {

struct TileArguments {
  importer::StudyOptions study;  // tiles, size, bakes, threads, quiet
  std::vector<double> lambdas{0, 2, 4};
  std::vector<std::string> only;   // draw renderers whose names contain one of these; empty: all
  std::filesystem::path assets;    // folder in which cooked assets are kept; empty: they are not kept
  std::filesystem::path pictures;  // folder for the pictures; empty: none are written
  std::string json, csv, command;
  bool print_json = false;

  bool wants(std::string_view renderer) const;
};

// The part of a usage text that lists the options of parseTileArguments, and notes that explain them.
inline constexpr const char kTileUsage[] =
    "[--tile NAME,...] [--lambda L,...] [--only TEXT,...] [--size N]\n"
    "       [--bakes FOLDER] [--assets FOLDER] [--pictures FOLDER] [--json FILE] [--csv FILE]\n"
    "       [--format text|json] [--threads N] [--command TEXT] [-q]\n";
inline constexpr const char kTileUsageNotes[] =
    "NAME is a builtin tile or a file of one; --only takes renderers whose name contains one of the texts,\n"
    "beside the normal map; --assets keeps what is cooked there, and takes what is there already; TEXT of\n"
    "--command stands in the JSON as what was typed";

// Options of one benchmark beside those of TileArguments: a function for each name, which takes the value.
using OwnOptions = std::map<std::string, std::function<void(const std::string&)>>;

// Parses the command line; prints help or an error and exits the program, with 1 for an error. Without --tile
// the tiles are the four of the papers.
TileArguments parseTileArguments(int argc, char** argv, const std::string& program, const std::string& usage,
                                 const OwnOptions& own);

// Values of OwnOptions: a list of numbers in [least, most], and one whole number. If `text` is none, these
// print an error and exit the program.
std::vector<double> numbersOf(const std::string& option, const std::string& text, double least, double most);
int wholeNumberOf(const std::string& option, const std::string& text, int least, int most);
std::vector<std::string> splitAtCommas(const std::string& text);

// Writes the files that the command line asks for, and prints either the JSON, or `heading` and a table.
// Returns the exit status.
int reportRows(const TileArguments& arguments, const importer::Study& study, const std::string& heading,
               const importer::StudyRows& rows);

}  // namespace loden::bench
