// From chunks to a material: what an asset declares, and its parts one by one. Internal to the container.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "material/asset/asset_format.h"
#include "material/asset/asset_issues.h"

namespace loden::asset {

// What table and HEAD say.
struct Contents {
  std::vector<ChunkInfo> chunks;
  int present = 0;         // chunks, from the front, that lie wholly inside the source
  Material skeleton;       // all that HEAD declares, without texels
  bool described = false;  // table and skeleton are valid, and the chunks are what HEAD asks for
};
Contents readContents(const ByteSource& source, IssueList& issues);

// Index in `chunks` of a part's chunk, by its place among the parts of its type; -1 if there is none.
int chunkOfPart(std::span<const ChunkInfo> chunks, const Material& skeleton, const Part& part);

// Reads, checks and decompresses one part into `material`, which afterwards has all that was loaded of it: of
// what is split the leading part alone, and with the rest, which goes to a material that has the leading
// part, the whole. `described` has the whole without texels. META goes to meta_json; HEAD is left as it is.
void loadPart(const ByteSource& source, const ChunkInfo& chunk, size_t index, const Part& part,
              const Material& described, Material& material, IssueList& issues);

// Loads what is present and forgets the rest, raising lambda_min to the finest level that is left. With
// `stop_at_first`, does no more work after an issue.
Material readAll(const ByteSource& source, bool stop_at_first, IssueList& issues);

// Checks table, header, checksums, padding and end, and decompresses HEAD alone.
void inspectAll(const ByteSource& source, IssueList& issues);

}  // namespace loden::asset
