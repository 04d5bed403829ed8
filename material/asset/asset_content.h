// Reads a material from chunks: what an asset declares, and its parts one by one. Internal to the container.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "material/asset/asset_format.h"
#include "material/asset/asset_issues.h"

namespace loden::asset {

// The content of the chunk table and of HEAD.
struct Contents {
  std::vector<ChunkInfo> chunks;
  int present = 0;         // number of chunks, from the front, that lie wholly inside the source
  Material skeleton;       // everything that HEAD declares, without texels
  bool described = false;  // table and skeleton are valid, and the chunks are those that HEAD asks for
};
Contents readContents(const ByteSource& source, IssueList& issues);

// The index in `chunks` of a part's chunk, found by the part's place among those of its type; -1 if there is
// none.
int chunkOfPart(std::span<const ChunkInfo> chunks, const Material& skeleton, const Part& part);

// Reads, checks and decompresses one part into `material`. If the part is split, a call for its leading part
// gives `material` that part alone; a later call for the rest completes it to the whole. `described` is the
// whole material without texels. META is stored in meta_json; HEAD changes nothing.
void loadPart(const ByteSource& source, const ChunkInfo& chunk, size_t index, const Part& part,
              const Material& described, Material& material, IssueList& issues);

// The material of all parts that are present, without those that are absent; lambda_min is raised to the
// finest level that is left. With `stop_at_first` it does no more work after an issue.
Material readAll(const ByteSource& source, bool stop_at_first, IssueList& issues);

// Checks table, header, checksums, padding and end of file. Decompresses HEAD only.
void inspectAll(const ByteSource& source, IssueList& issues);

}  // namespace loden::asset
