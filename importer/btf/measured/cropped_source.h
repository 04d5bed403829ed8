// A part of a measured BTF: whole sets of 400 x 400 texels do not fit into the memory that a cook has.
#pragma once

#include <memory>

#include "importer/btf/btf_source.h"

namespace loden::importer {

// The middle side x side texels. Issue kOption if the source has fewer along a side.
Result<std::unique_ptr<BtfSource>> croppedSource(std::unique_ptr<BtfSource> source, int side);

}  // namespace loden::importer
