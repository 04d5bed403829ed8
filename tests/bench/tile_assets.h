// The renderers of a tile: what is cooked for each, and how it is named in tables.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "importer/btf/baked_output.h"
#include "tests/bench/tile_arguments.h"
#include "tests/bench/tile_renderers.h"

namespace loden::bench {

// The one whose time is 1; always there.
inline constexpr const char* kBaseRenderer = "normal map";

// Those that `arguments` wants and that can draw this tile: marches need a height field, the mesh a surface
// of one chart, the table a power of two. `constant` is what a constant colour draws.
std::vector<TileRenderer> tileRenderers(const runtime::Device& device, const TileArguments& arguments,
                                        const std::string& tile, const importer::BakedOutput& baked,
                                        const importer::TileTracer& tracer,
                                        std::shared_ptr<const glm::vec3> constant);

}  // namespace loden::bench
