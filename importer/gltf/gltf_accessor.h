// Reads numbers from a glTF document's buffers, for checks of untrusted files. Not installed.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <vector>

#include "importer/gltf/gltf_document.h"
#include "importer/gltf/gltf_resource.h"

namespace loden::importer {

// The document's buffers, each opened once.
class GltfBuffers {
 public:
  // Both must outlive the buffers.
  GltfBuffers(const GltfDocument& document, const std::filesystem::path& file)
      : document_(document), file_(file) {}

  // Buffer i, which must exist. Issues: kBufferSource, or those of GltfResource::open, if it cannot be
  // opened.
  const Result<GltfResource>& at(size_t i);

 private:
  Result<GltfResource> open(size_t i) const;

  const GltfDocument& document_;
  const std::filesystem::path& file_;
  std::vector<std::optional<Result<GltfResource>>> opened_;
};

// A fault in an accessor or a buffer view: the number, and the words that follow its place.
struct AccessorFault {
  int id = 0;
  std::string text;
};

// The type and number of an accessor's elements.
struct AccessorShape {
  int component_type = 0;   // glTF's number
  int component_bytes = 0;  // 1, 2 or 4
  int components = 0;       // per element, 1 to 16
  int64_t count = 0;        // elements, at least 1
  int64_t elementBytes() const { return int64_t{component_bytes} * components; }
};
// The accessor's shape; nothing if type, componentType or count are not valid in glTF.
std::optional<AccessorShape> accessorShape(const nlohmann::ordered_json& accessor);
// The reason why accessorShape gives nothing: kAccessorType, kAccessorComponent or kAccessorCount.
std::optional<AccessorFault> shapeFault(const nlohmann::ordered_json& accessor);

// The reason why `count` elements of `element_bytes` from `offset` on do not lie inside the buffer view:
// kAccessorView, kViewBuffer, kViewStride or kAccessorRange; nothing if they do. Computed in 64 bits.
std::optional<AccessorFault> viewFault(const nlohmann::ordered_json& scene, int64_t view, int64_t offset,
                                       int64_t count, int64_t element_bytes);

// Calls visit(element, component, value) for every number of the accessor's own view, and then for those that
// a sparse accessor replaces. Returns a fault, without visiting what is faulty, if the accessor does not lie
// inside its buffers. An accessor without a view has zeros, which are not visited.
std::optional<AccessorFault> visitAccessor(
    const nlohmann::ordered_json& scene, GltfBuffers& buffers, size_t accessor,
    const std::function<void(uint64_t element, int component, double value)>& visit);

}  // namespace loden::importer
