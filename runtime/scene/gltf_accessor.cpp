// Reading numbers out of glTF buffers: every offset is checked in 64 bit before it is used.
#include <cmath>
#include <cstring>

#include "runtime/scene/gltf_reader.h"

namespace loden::runtime::gltf {
namespace {

constexpr uint64_t kMaxOwnBytes = uint64_t(1) << 30;  // of an accessor that is put together here

// Elements of an accessor: `data + i * stride`, i < count, inside its view or in `own`.
struct Elements {
  const unsigned char* data = nullptr;
  uint64_t stride = 0, count = 0;
  int component_type = 0;
  bool normalized = false;
  std::vector<unsigned char> own;
};

template <class T>
T load(const unsigned char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

float component(const unsigned char* from, int type, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
      return load<float>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<uint8_t>(from) / (normalized ? 255.0f : 1.0f);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<uint16_t>(from) / (normalized ? 65535.0f : 1.0f);
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return normalized ? std::fmax(load<int8_t>(from) / 127.0f, -1.0f) : load<int8_t>(from);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return normalized ? std::fmax(load<int16_t>(from) / 32767.0f, -1.0f) : load<int16_t>(from);
    default:
      return std::nanf("");
  }
}

std::optional<uint32_t> unsignedInteger(const unsigned char* from, int type) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return load<uint8_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return load<uint16_t>(from);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return load<uint32_t>(from);
    default:
      return {};
  }
}

// Where `count` elements of `element` bytes lie in a view.
Result<Elements> elementsOfView(const Reader& reader, int index, uint64_t offset, uint64_t count,
                                uint64_t element, const std::string& name, const std::string& place) {
  const auto bad = [&](int id, const std::string& text) { return reader.issue(id, place, name + text); };
  const Result<View> view = readView(reader, index, place);
  if (!view) return view.issue();
  const uint64_t stride = view->stride ? view->stride : element;
  if (stride < element) return bad(issue_id::kViewStride, ": byteStride is smaller than an element");
  if (offset > view->size || view->size - offset < element ||
      count - 1 > (view->size - offset - element) / stride)
    return bad(issue_id::kAccessorRange,
               " reaches beyond its buffer view of " + std::to_string(view->size) + " bytes");
  return Elements{view->data + offset, stride, count, 0, false, {}};
}

// A tight copy of the elements, or zeros where the accessor has no view.
Status ownElements(const Reader& reader, uint64_t element, const std::string& name, const std::string& place,
                   Elements& elements) {
  if (elements.count > kMaxOwnBytes / element)
    return reader.issue(issue_id::kGltfAccessor, place, name + " is larger than 1 GiB");
  std::vector<unsigned char> own(size_t(elements.count * element));
  for (uint64_t i = 0; elements.data && i < elements.count; ++i)
    std::memcpy(own.data() + i * element, elements.data + i * elements.stride, element);
  elements.own = std::move(own);
  elements.data = elements.own.data();
  elements.stride = element;
  return {};
}

// Overwrites the elements that a sparse accessor names.
Status replaceSparse(const Reader& reader, const tinygltf::Accessor& accessor, uint64_t element,
                     const std::string& name, const std::string& place, Elements& elements) {
  const auto& sparse = accessor.sparse;
  const auto bad = [&](int id, const std::string& text) { return reader.issue(id, place, name + text); };
  if (sparse.count < 1 || uint64_t(sparse.count) > elements.count)
    return bad(issue_id::kSparseCount, ": its sparse count must be from 1 to the number of elements");
  const auto count = static_cast<uint64_t>(sparse.count);
  const int index_bytes = tinygltf::GetComponentSizeInBytes(uint32_t(sparse.indices.componentType));
  if (index_bytes < 1 || index_bytes > 4 || sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    return bad(issue_id::kSparseIndices, ": its sparse indices are of an unknown type or place");
  const auto indices = elementsOfView(reader, sparse.indices.bufferView, uint64_t(sparse.indices.byteOffset),
                                      count, uint64_t(index_bytes), name, place);
  if (!indices) return bad(issue_id::kSparseIndices, ": its sparse indices: " + indices.issue().text);
  const auto values = elementsOfView(reader, sparse.values.bufferView, uint64_t(sparse.values.byteOffset),
                                     count, element, name, place);
  if (!values) return bad(issue_id::kSparseValues, ": its sparse values: " + values.issue().text);
  for (uint64_t i = 0; i < count; ++i) {
    const unsigned char* from = indices->data + i * indices->stride;
    const std::optional<uint32_t> index = unsignedInteger(from, sparse.indices.componentType);
    if (!index || *index >= elements.count)
      return bad(issue_id::kSparseRange, ": a sparse index lies beyond its elements");
    std::memcpy(elements.own.data() + *index * element, values->data + i * values->stride, element);
  }
  return {};
}

Result<Elements> readElements(const Reader& reader, int index, int components, const std::string& place,
                              const AccessorIssues& ids) {
  const auto bad = [&](int id, const std::string& text) { return reader.issue(id, place, text); };
  if (index < 0 || size_t(index) >= reader.model.accessors.size())
    return bad(ids.missing, "accessor " + std::to_string(index) + " does not exist");
  const tinygltf::Accessor& accessor = reader.model.accessors[size_t(index)];
  const std::string name = "accessor " + std::to_string(index);
  if (tinygltf::GetNumComponentsInType(uint32_t(accessor.type)) != components)
    return bad(ids.components, name + " must have " + std::to_string(components) + " components per element");
  const int component_bytes = tinygltf::GetComponentSizeInBytes(uint32_t(accessor.componentType));
  if (component_bytes < 1 || component_bytes > 4)
    return bad(issue_id::kAccessorComponent, name + " has an unknown component type");
  if (accessor.count == 0) return bad(issue_id::kAccessorCount, name + " is empty");
  const uint64_t element = uint64_t(component_bytes) * uint64_t(components);
  Elements elements;
  elements.count = accessor.count;
  if (accessor.bufferView >= 0) {
    auto stored = elementsOfView(reader, accessor.bufferView, accessor.byteOffset, accessor.count, element,
                                 name, place);
    if (!stored) return stored.issue();
    elements = *std::move(stored);
  }
  if (accessor.bufferView < 0 || accessor.sparse.isSparse)
    if (Status status = ownElements(reader, element, name, place, elements); !status) return status.issue();
  if (accessor.sparse.isSparse)
    if (Status status = replaceSparse(reader, accessor, element, name, place, elements); !status)
      return status.issue();
  elements.component_type = accessor.componentType;
  elements.normalized = accessor.normalized;
  return elements;
}

}  // namespace

int componentsOf(const Reader& reader, int accessor) {
  if (accessor < 0 || size_t(accessor) >= reader.model.accessors.size()) return 0;
  return tinygltf::GetNumComponentsInType(uint32_t(reader.model.accessors[size_t(accessor)].type));
}

Result<View> readView(const Reader& reader, int index, const std::string& place) {
  const auto bad = [&](int id, const std::string& text) { return reader.issue(id, place, text); };
  if (index < 0 || size_t(index) >= reader.model.bufferViews.size())
    return bad(issue_id::kAccessorView, "buffer view " + std::to_string(index) + " does not exist");
  if (const auto decoded = reader.decoded_views.find(index); decoded != reader.decoded_views.end())
    return View{decoded->second.data.data(), decoded->second.data.size(), decoded->second.stride};
  const tinygltf::BufferView& view = reader.model.bufferViews[index];
  if (view.buffer < 0 || size_t(view.buffer) >= reader.model.buffers.size())
    return bad(issue_id::kViewBuffer, "buffer " + std::to_string(view.buffer) + " does not exist");
  const std::vector<unsigned char>& buffer = reader.model.buffers[view.buffer].data;
  const uint64_t offset = view.byteOffset, length = view.byteLength;
  if (offset > buffer.size() || length > buffer.size() - offset)
    return bad(issue_id::kViewRange, "buffer view " + std::to_string(index) +
                                         " reaches beyond its buffer of " + std::to_string(buffer.size()) +
                                         " bytes");
  return View{buffer.data() + offset, length, view.byteStride};
}

Result<std::vector<float>> readFloats(const Reader& reader, int index, int components,
                                      const std::string& place, const AccessorIssues& ids) {
  const Result<Elements> elements = readElements(reader, index, components, place, ids);
  if (!elements) return elements.issue();
  const int component_bytes = tinygltf::GetComponentSizeInBytes(elements->component_type);
  std::vector<float> values;
  values.reserve(elements->count * components);
  for (uint64_t i = 0; i < elements->count; ++i) {
    const unsigned char* from = elements->data + i * elements->stride;
    for (int c = 0; c < components; ++c) {
      const float value =
          component(from + c * component_bytes, elements->component_type, elements->normalized);
      if (!std::isfinite(value))
        return reader.issue(
            elements->component_type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT ? ids.integers : ids.finite,
            place, "element " + std::to_string(i) + " is not finite, or of an unsupported type");
      values.push_back(value);
    }
  }
  return values;
}

Result<std::vector<uint32_t>> readIndices(const Reader& reader, int index, uint32_t limit,
                                          const std::string& place) {
  const Result<Elements> elements =
      readElements(reader, index, 1, place, {issue_id::kIndexAccessor, issue_id::kIndexType});
  if (!elements) return elements.issue();
  std::vector<uint32_t> values(elements->count);
  for (uint64_t i = 0; i < elements->count; ++i) {
    const unsigned char* from = elements->data + i * elements->stride;
    const std::optional<uint32_t> value = unsignedInteger(from, elements->component_type);
    if (!value) return reader.issue(issue_id::kIndexType, place, "indices must be unsigned integers");
    values[i] = *value;
    if (values[i] >= limit)
      return reader.issue(issue_id::kIndexRange, place,
                          "index " + std::to_string(i) + " is " + std::to_string(values[i]) +
                              ", but there are only " + std::to_string(limit) + " vertices");
  }
  return values;
}

}  // namespace loden::runtime::gltf
