// The only file that knows CLI11.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <new>

#include "importer/cli/command.h"
#include "importer/cli/interrupt.h"
#include "material/base/version.h"

namespace loden::importer {

struct Options::Impl {
  CLI::App* app = nullptr;
};

namespace {

CLI::Option* require(CLI::Option* option, bool required) {
  return required ? option->required() : option;
}

// "600k" -> 614400; throws CLI::ValidationError, which only CLI11 catches.
uint64_t parseBytes(const std::string& text) {
  size_t used = 0;
  double value = -1;
  try {
    value = std::stod(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  double unit = 1;
  if (used + 1 == text.size()) {
    const char suffix = text[used];
    unit = suffix == 'k' || suffix == 'K' ? 1024.
           : suffix == 'M'                ? 1048576.
           : suffix == 'G'                ? 1073741824.
                                          : 0;
    if (unit > 0) ++used;
  }
  if (used == 0 || used != text.size() || !(value >= 0) || value * unit > 1e18)
    throw CLI::ValidationError("'" + text + "' is no number of bytes; write for example 600k or 1.5M");
  return static_cast<uint64_t>(std::llround(value * unit));
}

}  // namespace

void Options::text(const std::string& names, std::string& value, const std::string& help, bool required) {
  require(impl_.app->add_option(names, value, help), required)->capture_default_str();
}

void Options::path(const std::string& names, std::filesystem::path& value, const std::string& help,
                   bool required) {
  auto* option = impl_.app->add_option_function<std::string>(
      names, [&value](const std::string& text) { value = text; }, help);
  require(option, required)->type_name("PATH")->default_str(value.string());
}

void Options::paths(const std::string& names, std::vector<std::filesystem::path>& value,
                    const std::string& help) {
  auto* option = impl_.app->add_option_function<std::vector<std::string>>(
      names, [&value](const std::vector<std::string>& texts) { value.assign(texts.begin(), texts.end()); },
      help);
  option->type_name("PATH")->required();
}

void Options::integer(const std::string& names, int& value, const std::string& help, int least, int most) {
  impl_.app->add_option(names, value, help)
      ->capture_default_str()
      ->check(CLI::Range(least, most))
      ->type_name("N");
}

void Options::bytes(const std::string& names, uint64_t& value, const std::string& help) {
  auto* option = impl_.app->add_option_function<std::string>(
      names, [&value](const std::string& text) { value = parseBytes(text); }, help);
  option->type_name("BYTES");
}

void Options::number(const std::string& names, double& value, const std::string& help, bool infinite) {
  auto* option = impl_.app->add_option(names, value, help)->type_name("X");
  option->check([infinite](const std::string& text) {
    const double number = std::strtod(text.c_str(), nullptr);
    return std::isfinite(number) || (infinite && !std::isnan(number))
               ? std::string()
               : "'" + text + "' is not a number that can be used";
  });
  if (!std::isnan(value)) option->capture_default_str();
}

void Options::flag(const std::string& names, bool& value, const std::string& help) {
  impl_.app->add_flag(names, value, help);
}

void Options::choice(const std::string& names, std::string& value, const std::vector<std::string>& words,
                     const std::string& help, bool required) {
  require(impl_.app->add_option(names, value, help), required)
      ->check(CLI::IsMember(words))
      ->capture_default_str();
}

void Options::texts(const std::string& names, std::vector<std::string>& value, const std::string& help) {
  impl_.app->add_option(names, value, help)
      ->delimiter(',')
      ->allow_extra_args(false);  // else it takes the positional, too
}

namespace {

constexpr const char* kGlobalsNote =
    "Also --format text|json, --threads N, -q and -v of every verb; see 'loden --help'.";

}  // namespace

void Options::footer(const std::string& text) {
  impl_.app->footer("\n" + text + "\n" + kGlobalsNote);
}

namespace {

void declareGlobals(CLI::App& app, GlobalOptions& globals) {
  app.add_option_function<std::string>(
         "--format", [&globals](const std::string& format) { globals.json = format == "json"; },
         "Form of the data on stdout: text or json")
      ->check(CLI::IsMember({"text", "json"}))
      ->default_str("text");
  app.add_option("--threads", globals.threads, "Threads to use; 0: all")
      ->check(CLI::Range(0, 1024))
      ->type_name("N");
  app.add_flag("-q,--quiet", globals.quiet, "No progress, no notes");
  app.add_flag("-v,--verbose", globals.verbose, "More of what a bake or cook found");
}

// Letters to insert, leave out, replace or swap with their neighbour until `a` is `b`.
size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::vector<size_t>> cost(a.size() + 1, std::vector<size_t>(b.size() + 1));
  for (size_t i = 0; i <= a.size(); ++i)
    for (size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = i + j;
        continue;
      }
      cost[i][j] =
          std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, cost[i - 1][j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  return cost[a.size()][b.size()];
}

// The verb that was meant by a word that is none; empty if none is close.
std::string closestVerb(const CLI::App& app, const std::string& word) {
  std::string closest;
  size_t least = 3;  // letters
  for (const CLI::App* verb : app.get_subcommands({}))
    if (const size_t distance = editDistance(word, verb->get_name());
        distance < std::min(least, verb->get_name().size() / 2 + 1))
      least = distance, closest = verb->get_name();
  return closest;
}

int explainUsage(const CLI::App& app, const CLI::ParseError& error, const char* first) {
  if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
  const bool unknown_verb = app.get_subcommands().empty() && first && *first && *first != '-';
  if (unknown_verb) {
    const std::string meant = closestVerb(app, first);
    std::fprintf(stderr, "loden: '%s' is no verb%s\n", first,
                 meant.empty() ? "" : ("; did you mean '" + meant + "'?").c_str());
  } else {
    std::fprintf(stderr, "loden: %s\n", error.what());
  }
  const CLI::App* verb = &app;
  for (const CLI::App* parsed : app.get_subcommands()) verb = parsed;
  std::fprintf(stderr, "See '%s%s --help'.\n", verb == &app ? "" : "loden ", verb->get_name().c_str());
  return kExitUsage;
}

// Data that did not reach stdout is an I/O error, whatever the verb found.
int flushed(int exit_code) {
  if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return exit_code;
  std::fprintf(stderr, "loden: standard output cannot be written: is the disk full?\n");
  return kExitIo;
}

int runGuarded(Command& command, const GlobalOptions& globals) {
  try {
    return flushed(command.run(globals));
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "loden %s: out of memory; try smaller sizes, or fewer threads\n",
                 std::string(command.name()).c_str());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "loden %s: %s\n", std::string(command.name()).c_str(), error.what());
  }
  return kExitRuntime;
}

constexpr const char* kFooter =
    "\nExit codes: 0 ok, 1 usage, 2 cannot read or write, 3 invalid input, 4 runtime or memory, 5 "
    "unsupported,\n"
    "7 difference found, 130 interrupted, 143 terminated. Data goes to stdout, messages and progress to "
    "stderr.\n\n"
    "From a tile to a material in a scene:\n"
    "  loden bake builtin:pulli -o out/pulli\n"
    "  loden cook out/pulli -o pulli.loden\n"
    "  loden pack room.gltf --material Curtain --asset pulli.loden -o room-loden.gltf";

}  // namespace

int runCommandLine(int argc, char** argv, const std::vector<std::unique_ptr<Command>>& commands) {
  GlobalOptions globals;
  globals.command_line = "loden";
  for (int i = 1; i < argc; ++i) globals.command_line += std::string(" ") + argv[i];

  CLI::App app{"Loden: bakes, cooks and checks materials whose look comes from geometry too small to model.",
               "loden"};
  app.set_version_flag("--version", "loden " LODEN_VERSION);
  app.footer(kFooter);
  app.require_subcommand(1);
  declareGlobals(app, globals);
  std::vector<CLI::App*> verbs;
  for (const auto& command : commands) {
    CLI::App* verb = app.add_subcommand(std::string(command->name()), std::string(command->summary()));
    verb->footer(std::string("\n") + kGlobalsNote);
    verb->fallthrough();  // the global options may stand behind the verb
    Options::Impl impl{verb};
    Options options(impl);
    command->declare(options);
    verbs.push_back(verb);
  }
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return explainUsage(app, error, argc > 1 ? argv[1] : nullptr);
  }
  watchInterrupts();
  for (size_t i = 0; i < verbs.size(); ++i)
    if (verbs[i]->parsed()) return runGuarded(*commands[i], globals);
  return kExitUsage;
}

}  // namespace loden::importer
