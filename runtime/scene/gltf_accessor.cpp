// Reading numbers out of glTF buffers: every offset is checked in 64 bit before it is used.
#include <cmath>
#include <cstring>

#include "runtime/scene/gltf_reader.h"

namespace loden::runtime::gltf {
namespace {

// Elements of an accessor: `data + i * stride`, i < count, inside its view.
struct Elements {
  const unsigned char* data = nullptr;
  uint64_t stride = 0, count = 0;
  int component_type = 0;
  bool normalized = false;
};

Result<Elements> readElements(const Reader& reader, int index, int components, const std::string& place) {
  const auto bad = [&](const std::string& text) {
    return reader.issue(issue_id::kGltfAccessor, place, text);
  };
  if (index < 0 || size_t(index) >= reader.model.accessors.size())
    return bad("accessor " + std::to_string(index) + " does not exist");
  const tinygltf::Accessor& accessor = reader.model.accessors[index];
  const std::string name = "accessor " + std::to_string(index);
  if (accessor.sparse.isSparse) return bad(name + " is sparse, which is not supported");
  if (tinygltf::GetNumComponentsInType(accessor.type) != components)
    return bad(name + " must have " + std::to_string(components) + " components per element");
  const int component_bytes = tinygltf::GetComponentSizeInBytes(accessor.componentType);
  if (component_bytes < 1 || component_bytes > 4) return bad(name + " has an unknown component type");

  const Result<View> view = readView(reader, accessor.bufferView, place);
  if (!view) return view.issue();
  const uint64_t element = uint64_t(component_bytes) * components;
  const uint64_t stride = view->stride ? view->stride : element;
  if (stride < element) return bad(name + ": byteStride is smaller than an element");
  const uint64_t offset = accessor.byteOffset, count = accessor.count;
  if (count == 0) return bad(name + " is empty");
  if (offset > view->size || view->size - offset < element ||
      count - 1 > (view->size - offset - element) / stride)
    return bad(name + " reaches beyond its buffer view of " + std::to_string(view->size) + " bytes");
  return Elements{view->data + offset, stride, count, accessor.componentType, accessor.normalized};
}

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

}  // namespace

Result<View> readView(const Reader& reader, int index, const std::string& place) {
  const auto bad = [&](const std::string& text) {
    return reader.issue(issue_id::kGltfAccessor, place, text);
  };
  if (index < 0 || size_t(index) >= reader.model.bufferViews.size())
    return bad("buffer view " + std::to_string(index) + " does not exist");
  const tinygltf::BufferView& view = reader.model.bufferViews[index];
  if (view.buffer < 0 || size_t(view.buffer) >= reader.model.buffers.size())
    return bad("buffer " + std::to_string(view.buffer) + " does not exist");
  const std::vector<unsigned char>& buffer = reader.model.buffers[view.buffer].data;
  const uint64_t offset = view.byteOffset, length = view.byteLength;
  if (offset > buffer.size() || length > buffer.size() - offset)
    return bad("buffer view " + std::to_string(index) + " reaches beyond its buffer of " +
               std::to_string(buffer.size()) + " bytes");
  return View{buffer.data() + offset, length, view.byteStride};
}

Result<std::vector<float>> readFloats(const Reader& reader, int index, int components,
                                      const std::string& place) {
  const Result<Elements> elements = readElements(reader, index, components, place);
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
        return reader.issue(issue_id::kGltfAccessor, place,
                            "element " + std::to_string(i) + " is not finite, or of an unsupported type");
      values.push_back(value);
    }
  }
  return values;
}

Result<std::vector<uint32_t>> readIndices(const Reader& reader, int index, uint32_t limit,
                                          const std::string& place) {
  const Result<Elements> elements = readElements(reader, index, 1, place);
  if (!elements) return elements.issue();
  std::vector<uint32_t> values(elements->count);
  for (uint64_t i = 0; i < elements->count; ++i) {
    const unsigned char* from = elements->data + i * elements->stride;
    switch (elements->component_type) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        values[i] = load<uint8_t>(from);
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        values[i] = load<uint16_t>(from);
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        values[i] = load<uint32_t>(from);
        break;
      default:
        return reader.issue(issue_id::kGltfAccessor, place, "indices must be unsigned integers");
    }
    if (values[i] >= limit)
      return reader.issue(issue_id::kGltfAccessor, place,
                          "index " + std::to_string(i) + " is " + std::to_string(values[i]) +
                              ", but there are only " + std::to_string(limit) + " vertices");
  }
  return values;
}

}  // namespace loden::runtime::gltf
