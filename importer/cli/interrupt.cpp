#include "importer/cli/interrupt.h"

#include <pthread.h>
#include <signal.h>
#include <unistd.h>

#include <cstdio>
#include <mutex>
#include <thread>

namespace loden::importer {
namespace {

std::recursive_mutex& commitMutex() {
  static auto* mutex = new std::recursive_mutex;  // outlives static destruction
  return *mutex;
}

}  // namespace

void watchInterrupts() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGINT);
  sigaddset(&signals, SIGTERM);
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  std::thread([signals] {
    int number = 0;
    sigwait(&signals, &number);
    commitMutex().lock();
    std::fputs("\nloden: interrupted\n", stderr);
    _exit(128 + number);
  }).detach();
}

CommitScope::CommitScope() {
  commitMutex().lock();
}
CommitScope::~CommitScope() {
  commitMutex().unlock();
}

}  // namespace loden::importer
