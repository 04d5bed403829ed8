#include "importer/base/doctor.h"

#include <Eigen/src/Core/util/Macros.h>
#include <OpenImageIO/imageio.h>
#include <ceres/version.h>
#include <embree3/rtcore_config.h>
#include <opensubdiv/version.h>
#include <sys/sysinfo.h>
#include <tbb/version.h>
#include <xxhash.h>
#include <zstd.h>

#include <fstream>
#include <thread>

namespace loden::importer {
namespace {

std::string processorName() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  return "unknown";
}

std::string mebibytes(unsigned long units, unsigned unit) {
  return std::to_string(units / 1024 * unit / 1024) + " MiB";
}

std::string xxhashVersion() {
  const unsigned v = XXH_versionNumber();
  return std::to_string(v / 10000) + "." + std::to_string(v / 100 % 100) + "." + std::to_string(v % 100);
}

}  // namespace

std::vector<std::pair<std::string, std::string>> systemFacts() {
  struct sysinfo memory {};
  sysinfo(&memory);
  const std::string eigen = std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) +
                            "." + std::to_string(EIGEN_MINOR_VERSION);
  return {{"processor", processorName()},
          {"threads", std::to_string(std::thread::hardware_concurrency())},
          {"memory", mebibytes(memory.totalram, memory.mem_unit)},
          {"memory free", mebibytes(memory.freeram + memory.bufferram, memory.mem_unit)},
          {"Embree", RTC_VERSION_STRING},
          {"OpenImageIO", OIIO_VERSION_STRING},
          {"OpenSubdiv", std::to_string(OPENSUBDIV_VERSION_MAJOR) + "." +
                             std::to_string(OPENSUBDIV_VERSION_MINOR) + "." +
                             std::to_string(OPENSUBDIV_VERSION_PATCH)},
          {"oneTBB", TBB_runtime_version()},
          {"Eigen", eigen},
          {"Ceres", CERES_VERSION_STRING},
          {"zstd", ZSTD_versionString()},
          {"xxHash", xxhashVersion()}};
}

}  // namespace loden::importer
