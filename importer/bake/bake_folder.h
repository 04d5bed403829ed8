// The state of a bake's folder while it is filled: which bake it belongs to, and which files it has. Not
// installed.
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
  // Makes the folder ready for this bake. A bake of something else in it is removed, or refused if the bake
  // is to be resumed or shared with other shards.
  static Result<BakeFolder> prepare(const std::filesystem::path& folder, const BakeManifest& manifest,
                                    bool resume, bool shared);

  const std::filesystem::path& path() const { return folder_; }
  // Runs `last`, writes bake.json, and removes the mark of an unfinished bake. Shards that find the bake
  // complete do this one after the other; `last` must have the same result when it runs again.
  Status finish(const std::function<Status()>& last) const;

 private:
  std::filesystem::path folder_;
  BakeManifest manifest_;
  bool shared_ = false;
};

// The XXH3-128 hash, in hex, of everything that the bake reads from the tile.
std::string tileHash(const Tile& tile);

}  // namespace loden::importer
