#include <malloc.h>

#include "importer/btf/measured/mapped_file.h"
#include "importer/cli/command.h"

int main(int argc, char** argv) {
  using namespace loden::importer;
  // Fits make and drop matrices of megabytes; given back to the system each time, their pages cost a third of
  // a cook.
  mallopt(M_MMAP_THRESHOLD, 32 << 20);  // the most there is
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
  exitWhereMappedFilesShrink();
  std::vector<std::unique_ptr<Command>> commands;
  commands.push_back(makeBakeCommand());
  commands.push_back(makeCookCommand());
  commands.push_back(makeInfoCommand());
  commands.push_back(makeValidateCommand());
  commands.push_back(makeExtractCommand());
  commands.push_back(makeCompareCommand());
  commands.push_back(makePackCommand());
  commands.push_back(makeTraceCommand());
  commands.push_back(makeStudyCommand());
  commands.push_back(makeDoctorCommand());
  return runCommandLine(argc, argv, commands);
}
