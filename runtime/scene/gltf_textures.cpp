// Textures: images decoded when a material first asks for them, samplers, and the way from texture
// coordinates to the image.
#include <cmath>

#include "material/base/gltf_extensions.h"
#include "runtime/scene/gltf_reader.h"
#include "runtime/scene/image_decode.h"

namespace loden::runtime::gltf {
namespace {

constexpr uint64_t kMaxScenePixels = uint64_t(1) << 28;  // 1 GiB decoded

constexpr const char* kTransform = "KHR_texture_transform";

std::string placeOf(const Reader& reader, int image) {
  const tinygltf::Image& source = reader.model.images[size_t(image)];
  std::string place = reader.file + ": " + at("images", size_t(image));
  if (!source.uri.empty()) place += " (" + source.uri.substr(0, 200) + ")";
  return place;
}

Result<std::span<const std::byte>> imageBytes(const Reader& reader, int image) {
  const tinygltf::Image& source = reader.model.images[size_t(image)];
  if (source.bufferView >= 0) {
    const Result<View> view = readView(reader, source.bufferView, at("images", size_t(image)));
    if (!view) return view.issue();
    return std::as_bytes(std::span(view->data, view->size));
  }
  if (source.image.empty())
    return Issue{issue_id::kImage, Severity::kError, placeOf(reader, image),
                 "cannot be read, or lies outside of the scene's folder"};
  return std::as_bytes(std::span(source.image));
}

Result<SceneImage> readImage(const Reader& reader, int image) {
  const auto bytes = imageBytes(reader, image);
  if (!bytes) return bytes.issue();
  uint64_t used = 0;
  for (const SceneImage& other : reader.scene.images) used += other.pixels.size();
  return decodeImage(*bytes, placeOf(reader, image), kMaxScenePixels - used);
}

// Index into the scene's images; -1 if there is no such picture, which is warned of once.
int imageIndex(Reader& reader, int image) {
  const auto [slot, fresh] = reader.images.try_emplace(image, -1);
  if (!fresh) return slot->second;
  auto decoded = readImage(reader, image);
  if (!decoded) {
    reader.scene.notes.push_back({decoded.issue().id, Severity::kWarning, decoded.issue().where,
                                  decoded.issue().text + "; drawn without it"});
    return -1;
  }
  slot->second = static_cast<int>(reader.scene.images.size());
  reader.scene.images.push_back(*std::move(decoded));
  return slot->second;
}

// The image that a texture shows: WebP's, if it has one, before glTF's own; -1 if none can be drawn.
int sourceOf(Reader& reader, size_t index) {
  const tinygltf::Texture& texture = reader.model.textures[index];
  int source = texture.source;
  if (const auto webp = texture.extensions.find("EXT_texture_webp"); webp != texture.extensions.end())
    source = indexMember(webp->second, "source").value_or(source);
  if (source >= 0 && size_t(source) < reader.model.images.size()) return source;
  reader.note(issue_id::kImage, at("textures", index), "has no image of a kind that is decoded");
  return -1;
}

Wrap wrapOf(int gltf) {
  if (gltf == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT) return Wrap::kMirror;
  return gltf == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE ? Wrap::kClamp : Wrap::kRepeat;
}

TextureSampler samplerOf(const Reader& reader, int index) {
  TextureSampler sampler;
  if (index < 0 || size_t(index) >= reader.model.samplers.size()) return sampler;
  const tinygltf::Sampler& source = reader.model.samplers[size_t(index)];
  sampler.wrap_u = wrapOf(source.wrapS);
  sampler.wrap_v = wrapOf(source.wrapT);
  sampler.magnify_linear = source.magFilter != TINYGLTF_TEXTURE_FILTER_NEAREST;
  const int min = source.minFilter;
  sampler.minify_linear = min != TINYGLTF_TEXTURE_FILTER_NEAREST &&
                          min != TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST &&
                          min != TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_LINEAR;
  if (min == TINYGLTF_TEXTURE_FILTER_NEAREST || min == TINYGLTF_TEXTURE_FILTER_LINEAR)
    sampler.mips = MipFilter::kNone;
  else if (min == TINYGLTF_TEXTURE_FILTER_NEAREST_MIPMAP_NEAREST ||
           min == TINYGLTF_TEXTURE_FILTER_LINEAR_MIPMAP_NEAREST)
    sampler.mips = MipFilter::kNearest;
  return sampler;
}

glm::vec2 pairMember(const tinygltf::Value& object, const char* key, glm::vec2 fallback) {
  if (!object.Has(key)) return fallback;
  const tinygltf::Value& value = object.Get(key);
  if (!value.IsArray() || value.ArrayLen() != 2 || !value.Get(0).IsNumber() || !value.Get(1).IsNumber())
    return fallback;
  const glm::vec2 pair(value.Get(0).GetNumberAsDouble(), value.Get(1).GetNumberAsDouble());
  return std::isfinite(pair.x + pair.y) ? pair : fallback;
}

// Scaled, turned, moved; counter-clockwise where v points down.
void readTransform(const tinygltf::Value& object, TextureUse& use) {
  const glm::vec2 scale = pairMember(object, "scale", glm::vec2(1)),
                  offset = pairMember(object, "offset", glm::vec2(0));
  const double rotation = numberMember(object, "rotation").value_or(0);
  if (!std::isfinite(rotation)) return;
  const float c = static_cast<float>(std::cos(rotation)), s = static_cast<float>(std::sin(rotation));
  use.image_u = {c * scale.x, s * scale.y, offset.x};
  use.image_v = {-s * scale.x, c * scale.y, offset.y};
  use.tex_coord = indexMember(object, "texCoord").value_or(use.tex_coord);
}

}  // namespace

TextureUse readTexture(Reader& reader, const TextureReference& reference, const std::string& place) {
  TextureUse use;
  if (reference.index < 0) return use;
  if (size_t(reference.index) >= reader.model.textures.size()) {
    reader.note(issue_id::kGltfExtension, place, "its texture does not exist; drawn without it");
    return use;
  }
  const int source = sourceOf(reader, size_t(reference.index));
  if (source < 0) return use;
  use.image = imageIndex(reader, source);
  use.sampler = samplerOf(reader, reader.model.textures[size_t(reference.index)].sampler);
  use.tex_coord = reference.tex_coord;
  if (reference.transform) readTransform(*reference.transform, use);
  if (use.tex_coord < 0 || use.tex_coord >= kUvSets) {
    reader.note(issue_id::kGltfExtension, place,
                "its texture wants TEXCOORD_" + std::to_string(use.tex_coord) +
                    ", and only the first four are drawn; drawn without it");
    use = {};
  }
  return use;
}

const tinygltf::Value* transformOf(const tinygltf::ExtensionMap& extensions) {
  const auto found = extensions.find(kTransform);
  return found != extensions.end() && found->second.IsObject() ? &found->second : nullptr;
}

TextureReference textureMember(const tinygltf::Value& object, const char* key) {
  TextureReference reference;
  if (!object.IsObject() || !object.Has(key) || !object.Get(key).IsObject()) return reference;
  const tinygltf::Value& info = object.Get(key);
  reference.index = indexMember(info, "index").value_or(-1);
  reference.tex_coord = indexMember(info, "texCoord").value_or(0);
  reference.scale = static_cast<float>(numberMember(info, "scale").value_or(1));
  if (!info.Has("extensions")) return reference;
  const tinygltf::Value& extensions = info.Get("extensions");
  if (extensions.IsObject() && extensions.Has(kTransform) && extensions.Get(kTransform).IsObject())
    reference.transform = &extensions.Get(kTransform);
  return reference;
}

}  // namespace loden::runtime::gltf
