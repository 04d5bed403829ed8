// A part of a measured BTF, since a whole set of 400 x 400 texels does not fit into the memory that a cook
// has.
#pragma once

#include <memory>

#include "importer/btf/btf_source.h"

namespace loden::importer {

// The middle side x side texels of the source. Issues: kOption if the source has fewer along a side.
Result<std::unique_ptr<BtfSource>> croppedSource(std::unique_ptr<BtfSource> source, int side);

}  // namespace loden::importer
