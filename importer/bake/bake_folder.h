// The state of a bake's folder while it fills: which bake it is of, which files it has. Not installed.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "importer/btf/baked_output.h"
#include "importer/tile/tile.h"
#include "importer/tile/tile_texture.h"
#include "material/base/result.h"

namespace loden::importer {

class BakeFolder {
 public:
  // Makes the folder ready for this bake: a bake of something else in it is removed, or refused if it is to
  // be resumed or shared with other shards.
  static Result<BakeFolder> prepare(const std::filesystem::path& folder, const BakeManifest& manifest,
                                    bool resume, bool shared);

  const std::filesystem::path& path() const { return folder_; }
  // Runs `last`, writes bake.json, and takes the mark of the unfinished bake away. Shards that find the bake
  // complete do this one after the other; `last` must give the same when it runs again.
  Status finish(const std::function<Status()>& last) const;

 private:
  std::filesystem::path folder_;
  BakeManifest manifest_;
  bool shared_ = false;
};

// XXH3-128 of everything that the bake reads from the tile, hex.
std::string tileHash(const Tile& tile);

}  // namespace loden::importer
