// Interrupts: Ctrl-C ends the process with exit code 130, but never in the middle of a final write.
#pragma once

namespace loden::importer {

// Lets a thread of its own receive SIGINT and SIGTERM. It waits for open commits and exits with 128 + the
// signal's number. Call this once, before any other thread starts, since threads inherit the signal mask.
void watchInterrupts();

// While an object of this class lives, signals do not end the process; use it around "write temporary file,
// rename".
class CommitScope {
 public:
  CommitScope();
  ~CommitScope();
  CommitScope(const CommitScope&) = delete;
  CommitScope& operator=(const CommitScope&) = delete;
};

}  // namespace loden::importer
