// The command line that benchmarks of tiles share, and what they print and write.
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
  std::vector<std::string> only;   // parts of renderers' names; empty: all
  std::filesystem::path assets;    // cooked ones are kept here; empty: they are not
  std::filesystem::path pictures;  // written here; empty: none
  std::string json, csv, command;
  bool print_json = false;

  bool wants(std::string_view renderer) const;
};

// Words of a usage text for what parseTileArguments knows, and what they mean.
inline constexpr const char kTileUsage[] =
    "[--tile NAME,...] [--lambda L,...] [--only TEXT,...] [--size N]\n"
    "       [--bakes FOLDER] [--assets FOLDER] [--pictures FOLDER] [--json FILE] [--csv FILE]\n"
    "       [--format text|json] [--threads N] [--command TEXT] [-q]\n";
inline constexpr const char kTileUsageNotes[] =
    "NAME is a builtin tile or a file of one; --only takes renderers whose name contains one of the texts,\n"
    "beside the normal map; --assets keeps what is cooked there, and takes what is there already; TEXT of\n"
    "--command stands in the JSON as what was typed";

// What takes the value of each option that is not of TileArguments, by the option's name.
using OwnOptions = std::map<std::string, std::function<void(const std::string&)>>;

// Ends the program, with 1 for what is wrong. Tiles are the four of the papers unless the line names some.
TileArguments parseTileArguments(int argc, char** argv, const std::string& program, const std::string& usage,
                                 const OwnOptions& own);

// For OwnOptions: a list of numbers in [least, most], and a whole one; end the program where it is none.
std::vector<double> numbersOf(const std::string& option, const std::string& text, double least, double most);
int wholeNumberOf(const std::string& option, const std::string& text, int least, int most);
std::vector<std::string> splitAtCommas(const std::string& text);

// Writes the files that the line asks for, and prints the JSON, or `heading` and a table. Returns the exit
// status.
int reportRows(const TileArguments& arguments, const importer::Study& study, const std::string& heading,
               const importer::StudyRows& rows);

}  // namespace loden::bench
