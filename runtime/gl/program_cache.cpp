#include "runtime/gl/program_cache.h"

#include <epoxy/gl.h>
#include <xxhash.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <random>
#include <vector>

namespace loden::runtime {
namespace {

constexpr uint64_t kMagic = 0x31304f5250444f4cull;  // "LODPRO01"
constexpr uint64_t kMaxBinary = 64u << 20;

// Local to one machine and driver, so native byte order will do.
struct Header {
  uint64_t magic = kMagic, key = 0, driver = 0, bytes = 0, hash = 0;
  uint64_t format = 0;
};

uint64_t hashOf(std::string_view text, uint64_t seed) {
  return XXH3_64bits_withSeed(text.data(), text.size(), seed);
}

// The file's payload if it is whole and meant for this key and driver; empty otherwise.
std::vector<char> readBinary(const std::filesystem::path& path, uint64_t key, uint64_t driver,
                             GLenum& format) {
  std::ifstream file(path, std::ios::binary);
  Header header;
  if (!file.read(reinterpret_cast<char*>(&header), sizeof header)) return {};
  if (header.magic != kMagic || header.key != key || header.driver != driver || header.bytes > kMaxBinary)
    return {};
  std::vector<char> bytes(header.bytes);
  if (!file.read(bytes.data(), std::streamsize(bytes.size()))) return {};
  if (XXH3_64bits(bytes.data(), bytes.size()) != header.hash) return {};
  format = GLenum(header.format);
  return bytes;
}

}  // namespace

ProgramCache::ProgramCache(const Device& device, std::filesystem::path folder) {
  const Capabilities& c = device.capabilities();
  if (folder.empty() || c.program_binary_formats == 0) return;
  folder_ = std::move(folder);
  driver_ = hashOf(c.vendor + "\n" + c.renderer + "\n" + c.version, 0);
}

uint64_t ProgramCache::key(std::string_view vertex, std::string_view fragment) const {
  return hashOf(fragment, hashOf(vertex, driver_));
}

std::filesystem::path ProgramCache::path(uint64_t key) const {
  char name[32];
  std::snprintf(name, sizeof name, "%016llx.program", static_cast<unsigned long long>(key));
  return folder_ / name;
}

GlProgram ProgramCache::load(uint64_t key) const {
  if (folder_.empty()) return {};
  GLenum format = 0;
  const std::vector<char> bytes = readBinary(path(key), key, driver_, format);
  if (bytes.empty()) return {};
  GlProgram program(glCreateProgram());
  glProgramBinary(program.name(), format, bytes.data(), GLsizei(bytes.size()));
  GLint linked = 0;
  glGetProgramiv(program.name(), GL_LINK_STATUS, &linked);
  return linked ? std::move(program) : GlProgram{};
}

void ProgramCache::store(uint64_t key, const GlProgram& program) const {
  if (folder_.empty()) return;
  GLint length = 0;
  glGetProgramiv(program.name(), GL_PROGRAM_BINARY_LENGTH, &length);
  if (length <= 0) return;
  std::vector<char> bytes(static_cast<size_t>(length));
  GLenum format = 0;
  glGetProgramBinary(program.name(), length, nullptr, &format, bytes.data());
  const Header header{kMagic, key, driver_, bytes.size(), XXH3_64bits(bytes.data(), bytes.size()), format};
  std::error_code error;
  std::filesystem::create_directories(folder_, error);
  // Written aside and renamed, so that another process never reads half a file.
  std::filesystem::path temporary = path(key);
  temporary += std::to_string(std::random_device{}());
  {
    std::ofstream file(temporary, std::ios::binary);
    file.write(reinterpret_cast<const char*>(&header), sizeof header);
    file.write(bytes.data(), std::streamsize(bytes.size()));
    if (!file) error = std::make_error_code(std::errc::io_error);
  }
  if (!error) std::filesystem::rename(temporary, path(key), error);
  if (error) std::filesystem::remove(temporary, error);
}

}  // namespace loden::runtime
