#include "sample_game/doctor.h"

#include <cstdio>
#include <nlohmann/json.hpp>

#include "runtime/gl/device.h"

namespace loden::walk {
namespace {

using Json = nlohmann::ordered_json;

Json facts(const runtime::Capabilities& gl) {
  return {{"schema", "loden/walk-doctor/1"},
          {"GL vendor", gl.vendor},
          {"GL renderer", gl.renderer},
          {"GL version", gl.version},
          {"GLSL version", gl.glsl_version},
          {"software renderer", gl.software},
          {"largest texture", gl.max_texture_side},
          {"largest volume", gl.max_volume_side},
          {"array layers", gl.max_array_layers},
          {"fragment textures", gl.max_fragment_textures},
          {"uniform block bytes", gl.max_uniform_block_bytes},
          {"program binary formats", gl.program_binary_formats},
          {"anisotropy", gl.max_anisotropy},
          {"GL lacks", gl.missing}};
}

}  // namespace

int runDoctor(bool json) {
  const auto device = runtime::Device::create({});
  if (!device) {
    std::fprintf(stderr, "loden_walk: %s [%d]\n", device.issue().text.c_str(), device.issue().id);
    return 4;
  }
  const Json all = facts((*device)->capabilities());
  if (json) return std::printf("%s\n", all.dump(1, ' ', false, Json::error_handler_t::replace).c_str()), 0;
  for (const auto& [what, value] : all.items()) {
    if (what == "schema") continue;
    const std::string text = value.is_string() ? value.get<std::string>()
                             : value.is_array() && value.empty()
                                 ? "nothing"
                                 : value.dump(-1, ' ', false, Json::error_handler_t::replace);
    std::printf("%-24s %s\n", what.c_str(), text.c_str());
  }
  return 0;
}

}  // namespace loden::walk
