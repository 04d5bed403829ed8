// Feeds a fuzz harness without libFuzzer: every stored input as it is, then damaged copies of it. The damage
// is the same in every run, so that a failure can be repeated.
//
//   HARNESS [--damages N] FILE|FOLDER ...
//
// N is the number of damaged copies of each input. An input that ends the process is kept as crash-input in
// the current folder.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <string_view>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

namespace fs = std::filesystem;
using Random = std::minstd_rand;

struct Input {
  std::string name, bytes;
};

std::vector<Input> readInputs(const std::vector<fs::path>& places) {
  std::vector<Input> inputs;
  const auto add = [&](const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    inputs.push_back({file.string(), std::string{std::istreambuf_iterator<char>(stream), {}}});
  };
  for (const fs::path& place : places) {
    if (!fs::is_directory(place)) {
      add(place);
      continue;
    }
    for (const auto& entry : fs::recursive_directory_iterator(place))
      if (entry.is_regular_file()) add(entry.path());
  }
  std::ranges::sort(inputs, {}, &Input::name);
  return inputs;
}

size_t below(Random& random, size_t end) {
  return end == 0 ? 0 : random() % end;
}

bool isDigit(char c) {
  return c >= '0' && c <= '9';
}

// Puts an extreme number in the place of one that is written in decimal digits.
void replaceNumber(std::string& bytes, Random& random) {
  constexpr std::string_view kNumbers[] = {
      "0", "-1", "1e999", "4294967295", "18446744073709551615", "2147483647", "-1e-40", "0.5", "NaN", "1e30"};
  const auto from =
      std::find_if(bytes.begin() + std::ptrdiff_t(below(random, bytes.size())), bytes.end(), isDigit);
  const auto to = std::find_if_not(from, bytes.end(), isDigit);
  bytes.replace(from, to, kNumbers[below(random, std::size(kNumbers))]);
}

// One damage: a flipped bit, an extreme byte or word, a part that is missing, doubled or of another input, or
// another number.
void damage(std::string& bytes, const std::vector<Input>& others, Random& random) {
  const size_t at = below(random, bytes.size());
  const size_t length = std::min(bytes.size() - at, 1 + below(random, 32));
  switch (below(random, 8)) {
    case 0:
      if (!bytes.empty()) bytes[at] = char(bytes[at] ^ (1 << below(random, 8)));
      return;
    case 1:
      if (!bytes.empty()) bytes[at] = "\x00\xff\x7f\x80\x01"[below(random, 5)];
      return;
    case 2: {
      constexpr uint32_t kWords[] = {0, 1, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fc00000, 0x7f800000, 65536};
      const uint32_t word = kWords[below(random, std::size(kWords))];
      if (bytes.size() - at >= sizeof word) std::memcpy(bytes.data() + at, &word, sizeof word);
      return;
    }
    case 3:
      bytes.erase(at, length);
      return;
    case 4:
      bytes.insert(at, bytes.substr(at, length));
      return;
    case 5: {
      const std::string& other = others[below(random, others.size())].bytes;
      bytes.replace(at, length, other, below(random, other.size()), length);
      return;
    }
    case 6:
      bytes.resize(at);
      return;
    default:
      replaceNumber(bytes, random);
  }
}

const std::string* current = nullptr;  // the input that the harness has

// Keeps the input that ends the process. It calls only what a signal handler may.
void keepInput(int signal) {
  const int file = open("crash-input", O_WRONLY | O_CREAT | O_TRUNC, 0644);
  if (file >= 0 && current != nullptr) {
    constexpr std::string_view kKept = "the input is kept as crash-input\n";
    const bool kept = write(file, current->data(), current->size()) == ssize_t(current->size());
    close(file);
    if (kept) (void)!write(STDERR_FILENO, kKept.data(), kKept.size());
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void run(const std::string& bytes) {
  current = &bytes;
  LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
}

}  // namespace

int main(int argc, char** argv) {
  int damages = 0;
  std::vector<fs::path> places;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--damages" && i + 1 < argc) {
      const std::string_view number = argv[++i];
      std::from_chars(number.data(), number.data() + number.size(), damages);
    } else {
      places.emplace_back(argument);
    }
  }
  const std::vector<Input> inputs = readInputs(places);
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) std::signal(signal, keepInput);
  Random random(1);
  for (const Input& input : inputs) {
    run(input.bytes);
    for (int i = 0; i < damages; ++i) {
      std::string bytes = input.bytes;
      for (size_t k = 1 + below(random, 3); k > 0; --k) damage(bytes, inputs, random);
      run(bytes);
    }
  }
  std::printf("%zu inputs replayed, %zu damaged copies tried\n", inputs.size(),
              inputs.size() * size_t(damages));
  return inputs.empty() ? 1 : 0;  // an empty corpus is a wrong path, not a pass
}
