// Ctrl-C ends the process with exit code 130 and never in the middle of a final write.
#pragma once

namespace loden::importer {

// From now on SIGINT and SIGTERM are received by a thread of their own, which waits for open commits and
// exits with 128 + the signal's number. Call once, before any other thread starts (they inherit the signal
// mask).
void watchInterrupts();

// While one lives, the process is not ended by a signal: stands around "write temporary file, rename".
class CommitScope {
 public:
  CommitScope();
  ~CommitScope();
  CommitScope(const CommitScope&) = delete;
  CommitScope& operator=(const CommitScope&) = delete;
};

}  // namespace loden::importer
