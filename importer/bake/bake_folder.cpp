#include "importer/bake/bake_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#include <xxhash.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <span>

#include "importer/base/file_read.h"
#include "importer/btf/baked_files.h"
#include "material/base/issues.h"
#include "material/system/atomic_file.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;

// While a bake is unfinished its manifest stands here.
fs::path unfinishedPath(const fs::path& folder) {
  return folder / "bake.unfinished.json";
}
fs::path finishedPath(const fs::path& folder) {
  return folder / "bake.json";
}

constexpr const char* kParts[] = {"btf", "flat", "visible", "vdim", "surface"};

void removeParts(const fs::path& folder) {
  std::error_code error;
  for (const char* part : kParts) fs::remove_all(folder / part, error);
  for (const char* layout : {"bonn", "bonn.part"})
    fs::remove_all(folder / layout, error);  // made of the parts
}

// A folder or file of a part's name that is no bake's, and holds something.
std::string foreignPart(const fs::path& folder) {
  for (const char* part : kParts) {
    std::error_code error;
    if (fs::exists(folder / part, error) && !fs::is_empty(folder / part, error)) return part;
  }
  return {};
}

Status writeText(const fs::path& path, const std::string& text) {
  return writeFileAtomically(path, std::as_bytes(std::span(text)));
}

// The manifest text in the folder, of a finished or unfinished bake; empty if there is none.
std::string presentManifest(const fs::path& folder) {
  bool unreadable = false;
  for (const fs::path& path : {unfinishedPath(folder), finishedPath(folder)}) {
    std::error_code error;
    if (!fs::exists(path, error)) continue;
    if (const auto text = readFile(path)) return *text;
    unreadable = true;
  }
  return unreadable ? "unreadable" : "";
}

// What a shard does to the folder's manifests, and the last pass, happens under this: one process at a time.
// The file is removed at the end, so that a folder filled by shards has the same files as any other. Network
// file systems lock only what is open for writing.
class ShardLock {
 public:
  Status acquire(const fs::path& folder) {
    path_ = folder / "bake.lock";
    do {
      release();
      file_ = open(path_.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
      if (file_ < 0)
        return Issue{issue_id::kCannotWrite, Severity::kError, path_.string(), std::strerror(errno)};
      while (flock(file_, LOCK_EX) != 0 && errno == EINTR) {
      }
    } while (!isCurrent());
    return {};
  }
  ~ShardLock() {
    if (file_ >= 0)
      unlink(path_.c_str());  // before it is released: who waits for it sees that, and takes the next
    release();
  }
  ShardLock() = default;
  ShardLock(const ShardLock&) = delete;
  ShardLock& operator=(const ShardLock&) = delete;

 private:
  // The file that is locked still stands at the path.
  bool isCurrent() const {
    struct stat mine, there;
    return fstat(file_, &mine) == 0 && stat(path_.c_str(), &there) == 0 && mine.st_dev == there.st_dev &&
           mine.st_ino == there.st_ino;
  }
  void release() {
    if (file_ >= 0) close(file_);
    file_ = -1;
  }

  fs::path path_;
  int file_ = -1;
};

template <class T>
void feed(XXH3_state_t* state, const T& value) {
  XXH3_128bits_update(state, &value, sizeof value);
}

void feedTexture(XXH3_state_t* state, const TileTexture* texture) {
  feed(state, texture != nullptr);
  if (!texture) return;
  feed(state, texture->width), feed(state, texture->height);
  feed(state, texture->wrap_u), feed(state, texture->wrap_v), feed(state, texture->nearest);
  XXH3_128bits_update(state, texture->texels.data(), texture->texels.size() * sizeof texture->texels[0]);
}

// Nothing for tiles without textures: their hash stays.
void feedTextures(XXH3_state_t* state, const Tile& tile) {
  for (const TexturePoint& point : tile.texture_points)
    feed(state, point.material), feed(state, point.base_color), feed(state, point.metallic_roughness);
  for (const TileMaterial& material : tile.materials) {
    feed(state, material.base_color), feed(state, material.metallic), feed(state, material.roughness);
    feedTexture(state, material.base_color_texture.get()),
        feedTexture(state, material.metallic_roughness_texture.get());
  }
}

}  // namespace

Result<BakeFolder> BakeFolder::prepare(const fs::path& folder, const BakeManifest& manifest, bool resume,
                                       bool shared) {
  const std::string wanted = manifestText(manifest);
  std::error_code error;
  fs::create_directories(folder, error);
  if (error)
    return Issue{issue_id::kCannotWrite, Severity::kError, folder.string(),
                 "cannot be created: " + error.message()};
  ShardLock lock;
  if (shared)
    if (const Status status = lock.acquire(folder); !status) return status.issue();
  const std::string present = presentManifest(folder);
  if (!present.empty() && present != wanted && (resume || shared))
    return Issue{issue_id::kExists, Severity::kError, folder.string(),
                 "holds a bake of another tile, with other options or by another version; choose an empty "
                 "folder, or bake neither resumed nor in shards"};
  if (const std::string part = present.empty() ? foreignPart(folder) : std::string(); !part.empty())
    return Issue{
        issue_id::kExists, Severity::kError, (folder / part).string(),
        "is not of a bake (no bake.json beside it) and would be overwritten; choose an empty folder"};
  // Renamed, not removed: a folder with parts is known as a bake's at any time. And by every shard that
  // begins: what it writes anew lacks the last pass.
  fs::rename(finishedPath(folder), unfinishedPath(folder), error);
  if (present != wanted && !present.empty()) removeParts(folder);
  for (const char* part : kParts) {
    fs::create_directories(folder / part, error);
    if (error)
      return Issue{issue_id::kCannotWrite, Severity::kError, (folder / part).string(),
                   "cannot be created: " + error.message()};
  }
  if (const auto stands = readFile(unfinishedPath(folder)); !stands || *stands != wanted)
    if (const Status status = writeText(unfinishedPath(folder), wanted); !status) return status.issue();
  BakeFolder result;
  result.folder_ = folder;
  result.manifest_ = manifest;
  result.shared_ = shared;
  return result;
}

Status BakeFolder::finish(const std::function<Status()>& last) const {
  ShardLock lock;
  if (shared_)
    if (Status status = lock.acquire(folder_); !status) return status;
  if (Status status = last(); !status) return status;
  if (Status status = flushFileSystem(folder_); !status) return status;
  if (const Status status = writeText(finishedPath(folder_), manifestText(manifest_)); !status) return status;
  std::error_code error;
  fs::remove(unfinishedPath(folder_), error);
  return {};
}

std::string tileHash(const Tile& tile) {
  XXH3_state_t* state = XXH3_createState();
  XXH3_128bits_reset(state);
  for (size_t v = 0; v < tile.positions.size(); ++v) {
    const LocalBrdf& brdf = tile.brdfs[v];
    feed(state, tile.positions[v]), feed(state, tile.normals[v]), feed(state, tile.params[v]);
    feed(state, brdf.diffuse), feed(state, brdf.specular), feed(state, brdf.exponent);
    if (brdf.alpha > 0) feed(state, brdf.f0), feed(state, brdf.alpha);
  }
  if (tile.aspect != 1) feed(state, tile.aspect);
  for (const glm::uvec3& triangle : tile.triangles) feed(state, triangle);
  for (const uint16_t chart : tile.charts) feed(state, chart);
  feedTextures(state, tile);
  const XXH128_hash_t hash = XXH3_128bits_digest(state);
  XXH3_freeState(state);
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return text;
}

}  // namespace loden::importer
