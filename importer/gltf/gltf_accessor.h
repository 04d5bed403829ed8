// Numbers out of a glTF document's buffers, for those that check what strangers wrote. Not installed.
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

  // Buffer i, which must exist; kBufferSource, or the issues of GltfResource::open, if it cannot be opened.
  const Result<GltfResource>& at(size_t i);

 private:
  Result<GltfResource> open(size_t i) const;

  const GltfDocument& document_;
  const std::filesystem::path& file_;
  std::vector<std::optional<Result<GltfResource>>> opened_;
};

// What is wrong with an accessor or a buffer view: the number, and words that follow its place.
struct AccessorFault {
  int id = 0;
  std::string text;
};

// What an accessor's elements are; nothing if type, componentType or count are none of glTF's.
struct AccessorShape {
  int component_type = 0;   // glTF's number
  int component_bytes = 0;  // 1, 2 or 4
  int components = 0;       // per element, 1 to 16
  int64_t count = 0;        // elements, at least 1
  int64_t elementBytes() const { return int64_t{component_bytes} * components; }
};
std::optional<AccessorShape> accessorShape(const nlohmann::ordered_json& accessor);
// Why there is none: kAccessorType, kAccessorComponent or kAccessorCount.
std::optional<AccessorFault> shapeFault(const nlohmann::ordered_json& accessor);

// Why `count` elements of `element_bytes` from `offset` on do not lie inside the buffer view; nothing if they
// do. kAccessorView, kViewBuffer, kViewStride or kAccessorRange. All in 64 bits.
std::optional<AccessorFault> viewFault(const nlohmann::ordered_json& scene, int64_t view, int64_t offset,
                                       int64_t count, int64_t element_bytes);

// Calls visit(element, component, value) for every number of the accessor's own view and then of what a
// sparse accessor puts in its place. A fault, without a call for what is faulty, if the accessor does not lie
// inside its buffers; an accessor without a view has zeros, which are not visited.
std::optional<AccessorFault> visitAccessor(
    const nlohmann::ordered_json& scene, GltfBuffers& buffers, size_t accessor,
    const std::function<void(uint64_t element, int component, double value)>& visit);

}  // namespace loden::importer
