// The last pass of a bake: fills what a view does not see of the surface from the views that see it. Not
// installed.
#pragma once

#include <filesystem>

#include "importer/btf/baked_output.h"
#include "material/base/result.h"

namespace loden::importer {

// Rewrites the views of a Flat-BTF whose files are all there, if its manifest asks for
// FillMethod::kNearestView. A texel that a view does not see takes its values under all lights from the view
// nearest in angle among those that see it. If no view sees it, it stays as it is. The pass reads only texels
// that views see and writes only the others, so that running it again, also after it was killed half way,
// changes nothing. It takes about 1 GiB of memory at most.
Status fillFromViews(const std::filesystem::path& folder, const BakeManifest& manifest, bool quiet);

}  // namespace loden::importer
