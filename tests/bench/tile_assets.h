// The list of all renderers of a tile: how they are named in tables, and how their assets are cooked.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "importer/btf/baked_output.h"
#include "tests/bench/tile_arguments.h"
#include "tests/bench/tile_renderers.h"

namespace loden::bench {

// The name of the renderer whose time is 1; it is always drawn.
inline constexpr const char* kBaseRenderer = "normal map";

// The renderers that `arguments` asks for and that can draw this tile: marches need a height field, the mesh
// needs a surface of one chart, the BTF table needs a size that is a power of two. `constant` is the colour
// that the renderer of one colour draws.
std::vector<TileRenderer> tileRenderers(const runtime::Device& device, const TileArguments& arguments,
                                        const std::string& tile, const importer::BakedOutput& baked,
                                        const importer::TileTracer& tracer,
                                        std::shared_ptr<const glm::vec3> constant);

}  // namespace loden::bench
