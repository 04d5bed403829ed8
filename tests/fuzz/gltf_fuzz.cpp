// Any bytes as a glTF scene, for the runtime's loader and for `loden validate`: no crash, no endless loop, no
// runaway allocation; and what the loader accepts holds together, so that a renderer may index without asking
// again.
#include <unistd.h>

#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "importer/gltf/pack.h"
#include "runtime/scene/gltf_scene.h"

namespace {

namespace fs = std::filesystem;

// A file of this process's own, in a folder with nothing else in it.
class InputFile {
 public:
  InputFile() {
    std::string name = (fs::temp_directory_path() / "loden_fuzz_XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~InputFile() {
    std::error_code error;
    fs::remove_all(folder_, error);
  }
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;
  fs::path write(const std::uint8_t* data, std::size_t size) const {
    const fs::path path = folder_ / "input.gltf";
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
    return path;
  }

 private:
  fs::path folder_;
};

void require(bool holds) {
  if (!holds) std::abort();
}

bool isFinite(const glm::vec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

void checkScene(const loden::runtime::Scene& scene) {
  for (const auto& mesh : scene.meshes) {
    for (const auto& vertex : mesh.vertices)
      require(isFinite(vertex.position) && std::isfinite(vertex.uv.x) && std::isfinite(vertex.uv.y));
    require(mesh.indices.size() % 3 == 0);
    for (const uint32_t index : mesh.indices) require(index < mesh.vertices.size());
  }
  for (const auto& instance : scene.instances) {
    require(instance.mesh >= 0 && size_t(instance.mesh) < scene.meshes.size());
    require(instance.material >= -1 && instance.material < static_cast<int>(scene.materials.size()));
    for (int c = 0; c < 4; ++c) require(isFinite(instance.world_from_local[c]));
  }
  for (const auto& material : scene.materials)
    require(!material.flat_btf ||
            (material.flat_btf->asset >= 0 && size_t(material.flat_btf->asset) < scene.assets.size()));
  for (const auto& light : scene.lights)
    require(isFinite(light.position) && isFinite(light.direction) && isFinite(light.intensity));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const InputFile file;
  const fs::path path = file.write(data, size);
  if (const auto scene = loden::runtime::loadGltfScene(path)) checkScene(*scene);
  (void)loden::importer::validateGltf(path);
  return 0;
}
