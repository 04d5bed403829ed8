// Every issue number with its name and what it says: the table that `loden validate --list` prints and that
// material/FORMAT.md repeats for assets.
#pragma once

#include <array>
#include <string_view>

#include "material/base/issues.h"

namespace loden {

struct IssueKind {
  int id = 0;
  std::string_view name;     // for programs; never changed
  std::string_view summary;  // one line
};

// By ascending number.
inline constexpr std::array kIssueKinds{
    IssueKind{issue_id::kCannotOpen, "cannot-open",
              "a file or folder is not there, not readable, or no regular file"},
    IssueKind{issue_id::kCannotRead, "cannot-read", "a file ends early, or the system cannot read it"},
    IssueKind{issue_id::kCannotWrite, "cannot-write",
              "a file cannot be written: no room, no permission, or something else stands there"},
    IssueKind{issue_id::kExists, "exists", "something else stands where output belongs"},
    IssueKind{issue_id::kImage, "image", "a picture is none, is damaged, or has another size than asked for"},
    IssueKind{issue_id::kMagic, "magic", "the file is no asset, or was damaged by a copy in text mode"},
    IssueKind{issue_id::kVersion, "version", "the file is of a major version that this reader does not know"},
    IssueKind{issue_id::kTruncated, "truncated", "the file ends inside its table or inside a chunk"},
    IssueKind{issue_id::kChunkTable, "chunk-table",
              "an entry of the chunk table contradicts itself or the format"},
    IssueKind{issue_id::kChunkChecksum, "chunk-checksum",
              "a chunk, or the table, does not have the checksum that it states"},
    IssueKind{issue_id::kChunkCodec, "chunk-codec",
              "a chunk is of an unknown codec, or is no sound zstd frame"},
    IssueKind{issue_id::kUnknownCritical, "unknown-critical",
              "a chunk of an unknown type is marked as critical"},
    IssueKind{issue_id::kPadding, "padding", "bytes between chunks are not zero, or there are too many"},
    IssueKind{issue_id::kOverlap, "overlap", "chunks, or a chunk and the table, overlap"},
    IssueKind{issue_id::kDuplicate, "duplicate", "there are more chunks of a type than the header declares"},
    IssueKind{issue_id::kTrailing, "trailing", "bytes follow the last chunk, or the end of the header"},
    IssueKind{issue_id::kLimit, "limit", "a number is beyond a limit of section 6"},
    IssueKind{issue_id::kMissingChunk, "missing-chunk", "a chunk that the header declares is absent"},
    IssueKind{issue_id::kOrder, "order", "chunks or bands stand in another order than the format has"},
    IssueKind{issue_id::kPrefix, "prefix", "the asset ends before its last chunk; it is valid, and coarser"},
    IssueKind{issue_id::kHeaderField, "header-field",
              "a field of the header, or META, holds what it may not hold"},
    IssueKind{issue_id::kDirections, "directions",
              "a direction set is not of its kind, or no set of unit vectors"},
    IssueKind{issue_id::kBandField, "band-field",
              "a band record, or its textures, hold what they may not hold"},
    IssueKind{issue_id::kMapField, "map-field",
              "geometry image, stored VDIM or surface maps hold what they may not hold"},
    IssueKind{issue_id::kMapSize, "map-size", "texels are not as many as the extents need"},
    IssueKind{issue_id::kNonFinite, "non-finite", "texels are not finite, or beyond kMaxValue"},
    IssueKind{issue_id::kGltfParse, "gltf-parse", "the file is no glTF 2.x, or a member is of a wrong type"},
    IssueKind{issue_id::kGltfDepth, "gltf-depth", "JSON nests deeper than 64 levels"},
    IssueKind{issue_id::kGltfPath, "gltf-path",
              "a uri leads outside of the document's folder, or is no relative uri"},
    IssueKind{issue_id::kGltfAccessor, "gltf-accessor",
              "a buffer, view, accessor or primitive does not lie inside of what it refers to"},
    IssueKind{issue_id::kGltfRequired, "gltf-required",
              "the file requires an extension that is not supported"},
    IssueKind{issue_id::kGltfExtension, "gltf-extension", "the use of an extension is not valid"},
    IssueKind{issue_id::kGltfNode, "gltf-node",
              "a node or scene refers to what is not there, or nodes form no trees"},
    IssueKind{issue_id::kTileGeometry, "tile-geometry", "a tile's mesh cannot be baked"},
    IssueKind{issue_id::kTileUv, "tile-uv", "a tile's texture coordinates cannot be baked with"},
    IssueKind{issue_id::kTileNonFinite, "tile-non-finite", "a tile's mesh has numbers that are not finite"},
    IssueKind{issue_id::kBakeManifest, "bake-manifest", "bake.json is none, or contradicts its folder"},
    IssueKind{issue_id::kBakeIncomplete, "bake-incomplete", "a bake is not finished, or lacks a map"},
    IssueKind{issue_id::kMeasured, "measured", "a measured BTF cannot be read"},
    IssueKind{issue_id::kGoal, "goal", "no plan meets the goal of a cook"},
    IssueKind{issue_id::kOption, "option", "an option or argument is wrong"},
    IssueKind{issue_id::kTileMaterial, "tile-material", "a tile's material or texture cannot be baked"},
    IssueKind{issue_id::kCamera, "camera", "a camera or script file holds what it may not hold"},
    IssueKind{issue_id::kGlContext, "gl-context", "there is no OpenGL context, or it lacks something"},
    IssueKind{issue_id::kShader, "shader", "a shader does not compile or link"},
    IssueKind{issue_id::kMemory, "memory", "there is not enough memory"},
    IssueKind{issue_id::kGlDebug, "gl-debug", "the OpenGL driver has said something"},
};

// Null for a number that is none.
constexpr const IssueKind* issueKind(int id) {
  for (const IssueKind& kind : kIssueKinds)
    if (kind.id == id) return &kind;
  return nullptr;
}

}  // namespace loden
