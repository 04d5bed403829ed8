// The one table of issue numbers: loader, `loden validate`, tests and documents all name issues from here.
// A number is never reused. Add a line; never renumber.
#pragma once

namespace loden::issue_id {

// 1xxx: I/O
inline constexpr int kCannotOpen = 1001;
inline constexpr int kCannotRead = 1002;
inline constexpr int kCannotWrite = 1003;
inline constexpr int kExists = 1004;
inline constexpr int kImage = 1005;
// 2xxx: container
inline constexpr int kMagic = 2001;
inline constexpr int kVersion = 2002;
inline constexpr int kTruncated = 2003;
inline constexpr int kChunkTable = 2004;
inline constexpr int kChunkChecksum = 2005;
inline constexpr int kChunkCodec = 2006;
inline constexpr int kUnknownCritical = 2007;
inline constexpr int kPadding = 2008;
inline constexpr int kOverlap = 2009;
inline constexpr int kDuplicate = 2010;
inline constexpr int kTrailing = 2011;
inline constexpr int kLimit = 2012;
inline constexpr int kMissingChunk = 2013;
inline constexpr int kOrder = 2014;
inline constexpr int kPrefix = 2015;
// 3xxx: header
inline constexpr int kHeaderField = 3001;
inline constexpr int kDirections = 3002;
// 4xxx: band and map data
inline constexpr int kBandField = 4001;
inline constexpr int kMapField = 4002;
inline constexpr int kMapSize = 4003;
inline constexpr int kNonFinite = 4004;
// 5xxx: glTF
inline constexpr int kGltfParse = 5001;
inline constexpr int kGltfDepth = 5002;
inline constexpr int kGltfPath = 5003;
inline constexpr int kGltfAccessor = 5004;
inline constexpr int kGltfRequired = 5005;
inline constexpr int kGltfExtension = 5006;
inline constexpr int kGltfNode = 5007;
// 6xxx: bake and cook input
inline constexpr int kTileGeometry = 6001;
inline constexpr int kTileUv = 6002;
inline constexpr int kTileNonFinite = 6003;
inline constexpr int kBakeManifest = 6004;
inline constexpr int kBakeIncomplete = 6005;
inline constexpr int kMeasured = 6006;
inline constexpr int kGoal = 6007;
inline constexpr int kOption = 6008;
inline constexpr int kTileMaterial = 6009;
inline constexpr int kCamera = 6010;
// 7xxx: GPU and memory
inline constexpr int kGlContext = 7001;
inline constexpr int kShader = 7002;
inline constexpr int kMemory = 7004;
inline constexpr int kGlDebug = 7005;

}  // namespace loden::issue_id
