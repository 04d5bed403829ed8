#include "importer/cli/sibling_program.h"

#include <signal.h>
#include <unistd.h>

namespace loden::importer {

std::filesystem::path siblingProgram(const std::string& name) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  const auto program = self.parent_path() / name;
  return !error && access(program.c_str(), X_OK) == 0 ? program : std::filesystem::path();
}

void becomeProgram(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
  std::string name = program.string();
  std::vector<std::string> words = arguments;
  std::vector<char*> pointers{name.data()};
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  sigset_t none, before;
  sigemptyset(&none);
  pthread_sigmask(SIG_SETMASK, &none, &before);  // watchInterrupts blocks some; they would stay blocked
  execv(name.c_str(), pointers.data());
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

}  // namespace loden::importer
