// The last pass of a bake: what a view does not see of the surface, from the views that see it. Not
// installed.
#pragma once

#include <filesystem>

#include "importer/btf/baked_output.h"
#include "material/base/result.h"

namespace loden::importer {

// Rewrites the views of a Flat-BTF whose files are all there, if its manifest asks for
// FillMethod::kNearestView: a texel that a view does not see takes its values under all lights from the view
// nearest in angle, of those that see it. Where no view does it stays as it is. Reads only what views see and
// writes only the rest, so that a second run, or one that was killed half way, changes nothing. About 1 GiB
// of memory at most.
Status fillFromViews(const std::filesystem::path& folder, const BakeManifest& manifest, bool quiet);

}  // namespace loden::importer
