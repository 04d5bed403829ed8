// What the harnesses share: inputs as files, and conditions that must hold.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <string_view>

namespace loden::fuzz {

// A folder of this process's own for input files, which is removed at the end.
class InputFolder {
 public:
  InputFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "loden_fuzz_XXXXXX").string();
    path_ = mkdtemp(name.data());
  }
  ~InputFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  InputFolder(const InputFolder&) = delete;
  InputFolder& operator=(const InputFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }
  // Writes a file and returns its path.
  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::filesystem::path file = path_ / name;
    std::ofstream(file, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    return file;
  }

 private:
  std::filesystem::path path_;
};

inline std::string_view textOf(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

// Ends the process, which counts as a finding, unless the condition holds.
inline void require(bool holds) {
  if (!holds) std::abort();
}

}  // namespace loden::fuzz
