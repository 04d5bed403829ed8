// EXT_meshopt_compression: buffer views, decompressed.
#include <meshoptimizer.h>

#include "runtime/scene/gltf_reader.h"

namespace loden::runtime::gltf {
namespace {

constexpr const char* kExtension = "EXT_meshopt_compression";
constexpr uint64_t kMaxDecoded = uint64_t(1) << 30;  // bytes of all views

struct Compressed {
  std::span<const unsigned char> bytes;
  size_t count = 0, stride = 0;
  std::string mode, filter;
};

Result<Compressed> describe(const Reader& reader, const tinygltf::Value& object, const std::string& place) {
  const auto bad = [&](const char* text) { return reader.issue(issue_id::kGltfExtension, place, text); };
  const auto member = [&](const char* key) { return uint64_t(indexMember(object, key).value_or(0)); };
  const std::optional<int> index = indexMember(object, "buffer");
  if (!index || size_t(*index) >= reader.model.buffers.size()) return bad("its buffer does not exist");
  const auto& buffer = reader.model.buffers[size_t(*index)].data;
  const uint64_t offset = member("byteOffset"), length = member("byteLength");
  if (offset > buffer.size() || length > buffer.size() - offset) return bad("reaches beyond its buffer");
  Compressed result{{buffer.data() + offset, size_t(length)},
                    size_t(member("count")),
                    size_t(member("byteStride")),
                    stringMember(object, "mode"),
                    stringMember(object, "filter")};
  const bool vertices = result.mode == "ATTRIBUTES", triangles = result.mode == "TRIANGLES";
  if (!vertices && !triangles && result.mode != "INDICES") return bad("its mode is unknown");
  if (vertices ? result.stride == 0 || result.stride > 256 || result.stride % 4 != 0
               : result.stride != 2 && result.stride != 4)
    return bad("its byteStride is not one of its mode's");
  if (result.count == 0 || (triangles && result.count % 3 != 0))
    return bad("its count is not one of its mode's");
  return result;
}

// Whether the filter exists and fits; applies it.
bool unfilter(const Compressed& compressed, std::vector<unsigned char>& data) {
  if (compressed.filter.empty() || compressed.filter == "NONE") return true;
  if (compressed.mode != "ATTRIBUTES") return false;
  const size_t stride = compressed.stride;
  if (compressed.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8))
    return meshopt_decodeFilterOct(data.data(), compressed.count, stride), true;
  if (compressed.filter == "QUATERNION" && stride == 8)
    return meshopt_decodeFilterQuat(data.data(), compressed.count, stride), true;
  if (compressed.filter == "EXPONENTIAL")
    return meshopt_decodeFilterExp(data.data(), compressed.count, stride), true;
  return false;
}

Result<std::vector<unsigned char>> decode(const Reader& reader, const tinygltf::Value& object, uint64_t room,
                                          const std::string& place) {
  const auto compressed = describe(reader, object, place);
  if (!compressed) return compressed.issue();
  if (compressed->count > room / compressed->stride)
    return reader.issue(issue_id::kGltfExtension, place, "decompressed views take more than 1 GiB");
  // The library works in groups of four vertices.
  std::vector<unsigned char> data((compressed->count + 3) / 4 * 4 * compressed->stride);
  const auto [bytes, count, stride, mode, filter] = *compressed;
  const int error = mode == "ATTRIBUTES"
                        ? meshopt_decodeVertexBuffer(data.data(), count, stride, bytes.data(), bytes.size())
                    : mode == "TRIANGLES"
                        ? meshopt_decodeIndexBuffer(data.data(), count, stride, bytes.data(), bytes.size())
                        : meshopt_decodeIndexSequence(data.data(), count, stride, bytes.data(), bytes.size());
  if (error != 0) return reader.issue(issue_id::kGltfExtension, place, "its data is damaged");
  if (!unfilter(*compressed, data))
    return reader.issue(issue_id::kGltfExtension, place, "its filter is unknown");
  data.resize(count * stride);
  return data;
}

}  // namespace

Status readCompressedViews(Reader& reader) {
  uint64_t room = kMaxDecoded;
  for (size_t i = 0; i < reader.model.bufferViews.size(); ++i) {
    const auto& extensions = reader.model.bufferViews[i].extensions;
    const auto found = extensions.find(kExtension);
    if (found == extensions.end() || !found->second.IsObject()) continue;
    auto data = decode(reader, found->second, room, at("bufferViews", i) + ".extensions." + kExtension);
    if (!data) return data.issue();
    room -= data->size();
    const auto stride = uint64_t(indexMember(found->second, "byteStride").value_or(0));
    reader.decoded_views[static_cast<int>(i)] = {*std::move(data), stride};
  }
  return {};
}

}  // namespace loden::runtime::gltf
