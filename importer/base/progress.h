// Shows the progress of long work: a bar on stderr if that is a terminal, otherwise a line from time to time,
// and nothing if quiet.
#pragma once

#include <chrono>
#include <cstdint>
#include <mutex>
#include <string>

namespace loden::importer {

class Progress {
 public:
  // `total` units of work; `quiet` prints nothing.
  Progress(std::string label, uint64_t total, bool quiet = false);
  ~Progress();  // ends the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // Adds finished work. Thread safe. `note` is shown after the bar, for example "12.3 Mray/s".
  void advance(uint64_t units = 1, const std::string& note = {});

 private:
  void print(const std::string& note, bool last);
  std::string label_;
  uint64_t total_ = 0, done_ = 0;
  bool quiet_ = false, terminal_ = false, finished_ = false;
  std::chrono::steady_clock::time_point start_, printed_;
  std::mutex mutex_;
};

}  // namespace loden::importer
