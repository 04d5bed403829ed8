// Any bytes as the scene that `loden pack` writes a material into: no crash, and a scene without issues stays
// one without. The material is the scene's first.
#include <cstdint>
#include <nlohmann/json.hpp>

#include "importer/gltf/pack.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using loden::fuzz::require;
namespace fs = std::filesystem;

// The name of the scene's first material, as far as it has one.
std::string firstMaterial(std::string_view bytes) {
  const auto scene = nlohmann::json::parse(bytes, nullptr, false);
  if (scene.is_discarded() || !scene.is_object()) return "material";
  const auto materials = scene.find("materials");
  if (materials == scene.end() || !materials->is_array() || materials->empty()) return "material";
  const auto& first = (*materials)[0];
  return first.is_object() && first.contains("name") && first["name"].is_string()
             ? first["name"].get<std::string>()
             : "material";
}

bool hasNoIssues(const fs::path& scene) {
  const auto issues = loden::importer::validateGltf(scene);
  return issues && issues->empty();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const loden::fuzz::InputFolder folder;
  const std::string_view bytes = loden::fuzz::textOf(data, size);
  const fs::path scene = folder.write("input.gltf", bytes), output = folder.path() / "output.gltf";
  const bool clean = hasNoIssues(scene);
  const bool odd = size % 2 == 1;
  loden::importer::PackOptions options;
  options.scene = scene, options.asset = LODEN_CORPUS_DIR "/asset_fuzz/near.loden", options.output = output;
  options.material = firstMaterial(bytes);
  options.embed = odd;
  if (size % 3 == 0) options.scale = glm::dvec2(4);
  const auto report = loden::importer::pack(options);
  if (report)
    require(!clean || hasNoIssues(output));
  else
    require(!report.issue().text.empty() && !fs::exists(output));
  std::error_code error;
  fs::remove(output, error);
  return 0;
}
