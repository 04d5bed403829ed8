// A BTF source whose values are all finite.
#pragma once

#include <memory>

#include "importer/base/repair_log.h"
#include "importer/btf/btf_source.h"

namespace loden::importer {

// The source with repairs, which are made view by view and recorded in the log. Values that are not finite
// are replaced channel by channel.
std::unique_ptr<BtfSource> repairedSource(std::unique_ptr<BtfSource> source, std::shared_ptr<RepairLog> log);

}  // namespace loden::importer
