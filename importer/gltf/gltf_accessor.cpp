#include "importer/gltf/gltf_accessor.h"

#include <cstring>
#include <limits>

#include "material/base/issues.h"

namespace loden::importer {
namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t kMaxCount = int64_t{1} << 32;

int bytesOfComponent(int64_t type) {
  return type == 5120 || type == 5121   ? 1
         : type == 5122 || type == 5123 ? 2
         : type == 5125 || type == 5126 ? 4
                                        : 0;
}

int componentsOf(const Json& accessor) {
  const auto type = accessor.find("type");
  if (type == accessor.end() || !type->is_string()) return 0;
  const std::string& shape = type->get_ref<const std::string&>();
  return shape == "SCALAR"                    ? 1
         : shape == "VEC2"                    ? 2
         : shape == "VEC3"                    ? 3
         : shape == "VEC4" || shape == "MAT2" ? 4
         : shape == "MAT3"                    ? 9
         : shape == "MAT4"                    ? 16
                                              : 0;
}

template <class Number>
double as(const char* at) {
  Number value;
  return std::memcpy(&value, at, sizeof value), static_cast<double>(value);
}

// As it is stored: normalised integers are not scaled.
double valueAt(const char* at, int component_type) {
  switch (component_type) {
    case 5120:
      return as<int8_t>(at);
    case 5121:
      return as<uint8_t>(at);
    case 5122:
      return as<int16_t>(at);
    case 5123:
      return as<uint16_t>(at);
    case 5125:
      return as<uint32_t>(at);
    default:
      return as<float>(at);
  }
}

int64_t offsetMember(const Json& object) {
  return object.is_object() && object.contains("byteOffset") ? integerMember(object, "byteOffset") : 0;
}

using Visit = std::function<void(uint64_t, int, double)>;
using Fault = std::optional<AccessorFault>;

Fault visitView(const Json& scene, GltfBuffers& buffers, int64_t view, int64_t offset,
                const AccessorShape& shape, const Visit& visit) {
  if (Fault fault = viewFault(scene, view, offset, shape.count, shape.elementBytes())) return fault;
  const Json& buffer_view = scene["bufferViews"][static_cast<size_t>(view)];
  const auto& buffer = buffers.at(static_cast<size_t>(integerMember(buffer_view, "buffer")));
  const int64_t stride = std::max(shape.elementBytes(), integerMember(buffer_view, "byteStride"));
  const uint64_t begin = static_cast<uint64_t>(offsetMember(buffer_view) + offset);
  const uint64_t length = static_cast<uint64_t>((shape.count - 1) * stride + shape.elementBytes());
  const AccessorFault beyond{issue_id::kAccessorRange, "does not lie inside its buffer"};
  if (!buffer || begin > buffer->size() || length > buffer->size() - begin) return beyond;
  const auto bytes = buffer->read(begin, length);
  if (!bytes) return beyond;
  for (int64_t i = 0; i < shape.count; ++i)
    for (int c = 0; c < shape.components; ++c)
      visit(static_cast<uint64_t>(i), c,
            valueAt(bytes->data() + i * stride + int64_t{c} * shape.component_bytes, shape.component_type));
  return {};
}

Fault visitSparse(const Json& scene, GltfBuffers& buffers, const Json& sparse, const AccessorShape& shape,
                  const Visit& visit) {
  const int64_t count = integerMember(sparse, "count");
  if (count < 1 || count > shape.count)
    return AccessorFault{issue_id::kSparseCount, "count is not in 1.." + std::to_string(shape.count)};
  const Json none;
  const auto part = [&](const char* key) -> const Json& { return sparse.contains(key) ? sparse[key] : none; };
  const Json &indices = part("indices"), &values = part("values");
  const int64_t type = integerMember(indices, "componentType");
  if (type != 5121 && type != 5123 && type != 5125)
    return AccessorFault{issue_id::kSparseIndices, "indices are of no unsigned type"};
  AccessorShape index{static_cast<int>(type), bytesOfComponent(type), 1, count}, value = shape;
  value.count = count;
  std::vector<uint64_t> places;
  bool inside = true;
  if (visitView(scene, buffers, integerMember(indices, "bufferView"), offsetMember(indices), index,
                [&](uint64_t, int, double place) {
                  places.push_back(static_cast<uint64_t>(place));
                  inside = inside && places.back() < static_cast<uint64_t>(shape.count);
                }))
    return AccessorFault{issue_id::kSparseIndices, "indices do not lie inside a bufferView"};
  if (!inside) return AccessorFault{issue_id::kSparseRange, "indices name elements that are not there"};
  if (visitView(scene, buffers, integerMember(values, "bufferView"), offsetMember(values), value,
                [&](uint64_t i, int c, double v) { visit(places[i], c, v); }))
    return AccessorFault{issue_id::kSparseValues, "values do not lie inside a bufferView"};
  return {};
}

}  // namespace

const Result<GltfResource>& GltfBuffers::at(size_t i) {
  if (opened_.size() <= i) opened_.resize(arraySize(document_.json, "buffers"));
  LODEN_CHECK_LT(i, opened_.size());
  if (!opened_[i]) opened_[i].emplace(open(i));
  return *opened_[i];
}

// Only the first buffer of a .glb is the binary chunk, and only without a uri.
Result<GltfResource> GltfBuffers::open(size_t i) const {
  const Json& buffer = document_.json["buffers"][i];
  const std::string place = file_.string() + ": buffers[" + std::to_string(i) + "]";
  if (buffer.is_object() && buffer.contains("uri") && buffer["uri"].is_string())
    return GltfResource::open(buffer["uri"].get<std::string>(), file_.parent_path(), place + ".uri");
  if (document_.binary && i == 0) return GltfResource::of(document_.binary_chunk);
  return Issue{issue_id::kBufferSource, Severity::kError, place, "has no uri, and is no binary chunk"};
}

std::optional<AccessorShape> accessorShape(const Json& accessor) {
  if (!accessor.is_object()) return {};
  const int64_t type = integerMember(accessor, "componentType"), count = integerMember(accessor, "count");
  const int bytes = bytesOfComponent(type), components = componentsOf(accessor);
  if (bytes == 0 || components == 0 || count < 1 || count > kMaxCount) return {};
  return AccessorShape{static_cast<int>(type), bytes, components, count};
}

std::optional<AccessorFault> shapeFault(const Json& accessor) {
  if (componentsOf(accessor) == 0) return AccessorFault{issue_id::kAccessorType, "has no type of glTF's"};
  if (bytesOfComponent(integerMember(accessor, "componentType")) == 0)
    return AccessorFault{issue_id::kAccessorComponent, "has no componentType of glTF's"};
  if (!accessorShape(accessor))
    return AccessorFault{issue_id::kAccessorCount, "count is not in 1.." + std::to_string(kMaxCount)};
  return {};
}

std::optional<AccessorFault> viewFault(const Json& scene, int64_t view, int64_t offset, int64_t count,
                                       int64_t element_bytes) {
  if (view < 0 || static_cast<size_t>(view) >= arraySize(scene, "bufferViews"))
    return AccessorFault{issue_id::kAccessorView, "names no existing bufferView"};
  const Json& buffer_view = scene["bufferViews"][static_cast<size_t>(view)];
  const int64_t buffer = integerMember(buffer_view, "buffer");
  if (buffer < 0 || static_cast<size_t>(buffer) >= arraySize(scene, "buffers"))
    return AccessorFault{issue_id::kViewBuffer, "lies in a bufferView of no existing buffer"};
  const int64_t length = integerMember(buffer_view, "byteLength"), begin = offsetMember(buffer_view);
  const int64_t given = integerMember(buffer_view, "byteStride");
  if (given > 252 || (given > 0 && given < element_bytes))
    return AccessorFault{issue_id::kViewStride, "lies in a bufferView with a byteStride that does not fit"};
  const int64_t stride = std::max(element_bytes, given);
  if (begin < 0 || offset < 0 || length < offset || (count - 1) * stride + element_bytes > length - offset)
    return AccessorFault{issue_id::kAccessorRange, "does not lie inside its bufferView"};
  return {};
}

std::optional<AccessorFault> visitAccessor(const Json& scene, GltfBuffers& buffers, size_t index,
                                           const Visit& visit) {
  const Json& accessor = scene["accessors"][index];
  const auto shape = accessorShape(accessor);
  if (!shape) return shapeFault(accessor);
  if (accessor.contains("bufferView"))
    if (Fault fault = visitView(scene, buffers, integerMember(accessor, "bufferView"), offsetMember(accessor),
                                *shape, visit))
      return fault;
  return accessor.contains("sparse") ? visitSparse(scene, buffers, accessor["sparse"], *shape, visit)
                                     : Fault();
}

}  // namespace loden::importer
