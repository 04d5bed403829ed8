// Skins and animations: what refers to nodes that have been read.
#include <algorithm>
#include <cmath>

#include "runtime/scene/gltf_reader.h"

namespace loden::runtime::gltf {
namespace {

constexpr size_t kMaxJoints = 65536;  // per skin

// The scene's node of a glTF node; -1 if it is not part of the scene.
int sceneNode(const Reader& reader, int node) {
  return node >= 0 && size_t(node) < reader.nodes.size() ? reader.nodes[size_t(node)] : -1;
}

Result<Skin> readSkin(const Reader& reader, size_t index) {
  const tinygltf::Skin& source = reader.model.skins[index];
  const std::string place = at("skins", index);
  if (source.joints.empty() || source.joints.size() > kMaxJoints)
    return reader.issue(issue_id::kGltfNode, place, "must have from 1 to 65536 joints");
  Skin skin;
  for (const int joint : source.joints) {
    skin.joints.push_back(sceneNode(reader, joint));
    if (skin.joints.back() < 0)
      return reader.issue(issue_id::kGltfNode, place,
                          "joint " + std::to_string(joint) + " is no node of the scene");
  }
  skin.joint_from_mesh.resize(skin.joints.size(), glm::mat4(1));
  if (source.inverseBindMatrices < 0) return skin;
  const auto matrices = readFloats(reader, source.inverseBindMatrices, 16, place + ".inverseBindMatrices",
                                   AccessorIssues::others());
  if (!matrices) return matrices.issue();
  if (matrices->size() < 16 * skin.joints.size())
    return reader.issue(issue_id::kGltfAccessor, place + ".inverseBindMatrices",
                        "has fewer than one per joint");
  for (size_t i = 0; i < 16 * skin.joints.size(); ++i)
    skin.joint_from_mesh[i / 16][int(i % 16) / 4][int(i % 4)] = (*matrices)[i];
  return skin;
}

// Every joint that a skinned mesh names must exist. Skins and meshes that do not fit are errors.
Status checkInstance(const Reader& reader, const Instance& instance) {
  const Mesh& mesh = reader.scene.meshes[size_t(instance.mesh)];
  const size_t joints = reader.scene.skins[size_t(instance.skin)].joints.size();
  for (const Influences& influences : mesh.influences)
    for (size_t k = 0; k < influences.joints.size(); ++k)
      if (influences.weights[k] != 0 && influences.joints[k] >= joints)
        return reader.issue(issue_id::kGltfNode, at("skins", size_t(instance.skin)),
                            "mesh " + mesh.name + " names joint " + std::to_string(influences.joints[k]) +
                                ", and there are only " + std::to_string(joints));
  return {};
}

std::optional<AnimationTarget> targetOf(const std::string& path) {
  if (path == "translation") return AnimationTarget::kTranslation;
  if (path == "rotation") return AnimationTarget::kRotation;
  if (path == "scale") return AnimationTarget::kScale;
  if (path == "weights") return AnimationTarget::kWeights;
  return {};
}

// Numbers per element of an animation's output: weights are stored one by one.
int storedWidth(AnimationTarget target) {
  if (target == AnimationTarget::kWeights) return 1;
  return target == AnimationTarget::kRotation ? 4 : 3;
}

Status readKeys(const Reader& reader, const tinygltf::AnimationSampler& sampler, const std::string& place,
                AnimationChannel& channel) {
  if (sampler.interpolation == "STEP") channel.interpolation = Interpolation::kStep;
  if (sampler.interpolation == "CUBICSPLINE") channel.interpolation = Interpolation::kCubic;
  auto times = readFloats(reader, sampler.input, 1, place + ".input", AccessorIssues::others());
  if (!times) return times.issue();
  for (size_t i = 1; i < times->size(); ++i)
    if (!((*times)[i] > (*times)[i - 1]))
      return reader.issue(issue_id::kGltfAccessor, place + ".input",
                          "time " + std::to_string(i) + " is not later than the one before");
  auto values = readFloats(reader, sampler.output, storedWidth(channel.target), place + ".output",
                           AccessorIssues::others());
  if (!values) return values.issue();
  const size_t parts = channel.interpolation == Interpolation::kCubic ? 3 : 1;
  channel.width = size_t(storedWidth(channel.target));
  if (channel.target == AnimationTarget::kWeights) channel.width = values->size() / (times->size() * parts);
  if (channel.width == 0 || values->size() != times->size() * parts * channel.width)
    return reader.issue(
        issue_id::kGltfAccessor, place + ".output",
        "has " + std::to_string(values->size()) + " numbers for " + std::to_string(times->size()) + " times");
  channel.times = *std::move(times);
  channel.values = *std::move(values);
  return {};
}

Result<SceneAnimation> readAnimation(Reader& reader, size_t index) {
  const tinygltf::Animation& source = reader.model.animations[index];
  SceneAnimation animation;
  animation.name = source.name;
  for (size_t i = 0; i < source.channels.size(); ++i) {
    const tinygltf::AnimationChannel& from = source.channels[i];
    const std::string place = at("animations", index) + "." + at("channels", i);
    const std::optional<AnimationTarget> target = targetOf(from.target_path);
    AnimationChannel channel;
    channel.node = sceneNode(reader, from.target_node);
    if (channel.node < 0) continue;  // not part of the scene
    if (!target) {
      reader.note(issue_id::kGltfNode, place, "moves what is not moved: " + from.target_path.substr(0, 40));
      continue;
    }
    channel.target = *target;
    if (from.sampler < 0 || size_t(from.sampler) >= source.samplers.size())
      return reader.issue(issue_id::kGltfNode, place, "its sampler does not exist");
    const std::string sampler = at("animations", index) + "." + at("samplers", size_t(from.sampler));
    if (Status status = readKeys(reader, source.samplers[size_t(from.sampler)], sampler, channel); !status)
      return status.issue();
    animation.duration = std::max(animation.duration, double(channel.times.back()));
    animation.channels.push_back(std::move(channel));
  }
  return animation;
}

}  // namespace

Status readSkins(Reader& reader) {
  for (size_t i = 0; i < reader.model.skins.size(); ++i) {
    auto skin = readSkin(reader, i);
    if (!skin) return skin.issue();
    reader.scene.skins.push_back(*std::move(skin));
  }
  for (const Instance& instance : reader.scene.instances)
    if (instance.skin >= 0)
      if (Status status = checkInstance(reader, instance); !status) return status;
  return {};
}

Status readAnimations(Reader& reader) {
  for (size_t i = 0; i < reader.model.animations.size(); ++i) {
    auto animation = readAnimation(reader, i);
    if (!animation) return animation.issue();
    reader.scene.animations.push_back(*std::move(animation));
  }
  return {};
}

}  // namespace loden::runtime::gltf
