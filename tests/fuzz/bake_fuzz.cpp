// Any bytes as the bake.json of a baked output, beside the images of a small bake: no crash, and maps that
// are read have the sizes that the manifest says.
#include <cstdint>

#include "importer/bake/bake.h"
#include "importer/btf/baked_output.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using loden::fuzz::require;
using namespace loden::importer;

size_t square(int side) {
  return size_t(side) * size_t(side);
}

void readMaps(const BakedOutput& bake) {
  const BakeManifest& manifest = bake.manifest();
  const size_t directions = manifest.directions.samples.size();
  require(manifest.size > 0 && manifest.geometry_size > 0 && directions > 0);
  const int last = static_cast<int>(directions) - 1;
  if (const auto view = bake.btfView(last)) require(view->size() == directions * square(manifest.size));
  if (const auto view = bake.flatView(0)) require(view->size() == directions * square(manifest.flat_size));
  if (const auto view = bake.visibleView(0)) require(view->size() == square(manifest.flat_size));
  for (const glm::ivec2 size : manifest.vdims)
    if (const auto vdim = bake.vdim(size.x, size.y))
      require(vdim->size() == size_t(size.x) * size_t(size.y) * square(manifest.size));
  if (const auto geometry = bake.geometry()) require(geometry->size() == square(manifest.geometry_size));
  if (const auto maps = bake.surface()) require(maps->normal.size() == square(manifest.surface_size));
}

// A folder with a whole bake of four texels, made once.
class SmallBake {
 public:
  SmallBake() {
    BakeOptions options;
    options.size = 4;
    options.geometry_size = 8;
    options.directions = loden::concentricDirections(2);
    options.vdims = {{2, 3}};
    options.quiet = true;
    const auto tile = builtinTile("pulli", 8);
    require(tile.ok() && bake(*tile, "builtin:pulli", folder_.path(), options).ok());
  }
  const loden::fuzz::InputFolder& folder() const { return folder_; }

 private:
  loden::fuzz::InputFolder folder_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const SmallBake small;
  small.folder().write("bake.json", loden::fuzz::textOf(data, size));
  if (const auto opened = BakedOutput::open(small.folder().path())) readMaps(*opened);
  return 0;
}
