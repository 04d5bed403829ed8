#include "importer/base/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace loden::importer {
namespace {

constexpr int kBarColumns = 28;

std::string duration(double seconds) {
  char text[32];
  const int s = static_cast<int>(seconds + 0.5);
  std::snprintf(text, sizeof text, "%d:%02d:%02d", s / 3600, s / 60 % 60, s % 60);
  return text;
}

}  // namespace

Progress::Progress(std::string label, uint64_t total, bool quiet)
    : label_(std::move(label)),
      total_(std::max<uint64_t>(total, 1)),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(std::chrono::steady_clock::now()),
      printed_(start_) {}

Progress::~Progress() {
  if (quiet_) return;
  if (!finished_ && done_ > 0) print({}, true);
}

void Progress::advance(uint64_t units, const std::string& note) {
  const std::lock_guard lock(mutex_);
  done_ += units;
  if (quiet_ || finished_) return;
  const auto now = std::chrono::steady_clock::now();
  const bool last = done_ >= total_;
  const double interval = terminal_ ? 0.1 : 10.0;  // seconds between two prints
  if (!last && std::chrono::duration<double>(now - printed_).count() < interval) return;
  printed_ = now;
  print(note, last);
}

void Progress::print(const std::string& note, bool last) {
  finished_ = finished_ || last;
  const double elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double share = std::min(1.0, double(done_) / double(total_));
  const double left = share > 0 ? elapsed / share - elapsed : 0;
  const std::string time = last ? duration(elapsed) : duration(left) + " left";
  const char* gap = note.empty() ? "" : "  ";
  if (!terminal_) {
    std::fprintf(stderr, "%s: %3.0f %%  %s%s%s\n", label_.c_str(), 100 * share, time.c_str(), gap,
                 note.c_str());
    return;
  }
  const int filled = static_cast<int>(share * kBarColumns);
  const std::string bar = std::string(filled, '#') + std::string(kBarColumns - filled, '-');
  std::fprintf(stderr, "\r\033[K%s [%s] %3.0f %%  %s%s%s%s", label_.c_str(), bar.c_str(), 100 * share,
               time.c_str(), gap, note.c_str(), last ? "\n" : "");
  std::fflush(stderr);
}

}  // namespace loden::importer
