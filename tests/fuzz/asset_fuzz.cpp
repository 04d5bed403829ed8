// Any bytes as an asset: no crash, no runaway allocation, and what is accepted can be written and read again.
#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "material/asset/asset.h"
#include "tests/fuzz/fuzz_input.h"

namespace {

using Bytes = std::vector<std::byte>;
using loden::AssetFile;
using loden::Share;
using loden::fuzz::require;

constexpr size_t kPreamble = 32, kEntry = 48, kHash = 24;

template <class Number>
Number numberAt(const Bytes& bytes, size_t at) {
  Number value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

void setHash(Bytes& bytes, size_t at, uint64_t hash) {
  std::memcpy(bytes.data() + at, &hash, sizeof hash);
}

// Checksums stop a fuzzer at the door: makes them right, so that what stands behind them is reached.
void repairChecksums(Bytes& bytes) {
  if (bytes.size() < kPreamble) return;
  const uint64_t count = numberAt<uint32_t>(bytes, 16);
  if (count > (bytes.size() - kPreamble) / kEntry) return;
  for (uint64_t i = 0; i < count; ++i) {
    const size_t entry = kPreamble + i * kEntry;
    const auto offset = numberAt<uint64_t>(bytes, entry + 16), stored = numberAt<uint64_t>(bytes, entry + 24);
    if (offset > bytes.size() || stored > bytes.size() - offset) continue;
    setHash(bytes, entry + 40, XXH3_64bits(bytes.data() + offset, stored));
  }
  Bytes hashed(bytes.begin(), bytes.begin() + kHash);
  hashed.insert(hashed.end(), bytes.begin() + kPreamble, bytes.begin() + kPreamble + count * kEntry);
  setHash(bytes, kHash, XXH3_64bits(hashed.data(), hashed.size()));
}

void loadParts(const Bytes& bytes) {
  const auto file = AssetFile::open(loden::memorySource(bytes, "fuzz"), "fuzz");
  if (!file) return;
  for (size_t band = 0; band < file->skeleton().bands.size(); ++band) {
    (void)file->loadBand(static_cast<int>(band));
    const auto lead = file->loadBand(static_cast<int>(band), Share::kLead);
    if (lead) (void)file->loadBand(static_cast<int>(band), Share::kWhole, &*lead);
  }
  (void)file->loadGeometry();
  (void)file->loadStoredVdim();
  (void)file->loadSurface();
  const auto lead = file->loadSurface(Share::kLead);
  if (lead) (void)file->loadSurface(Share::kWhole, &*lead);
}

void tryAsset(const Bytes& bytes) {
  const auto issues = loden::validateAsset(bytes, "fuzz");
  const auto material = loden::parseAsset(bytes, "fuzz");
  require(material.ok() == issues.empty());
  loadParts(bytes);
  if (!material) return;
  const auto written = loden::serializeAsset(*material);
  require(written.ok());
  const auto again = loden::parseAsset(*written, "fuzz");
  require(again.ok());
  require(*loden::serializeAsset(*again) == *written);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto span = std::as_bytes(std::span(data, size));
  Bytes bytes(span.begin(), span.end());
  tryAsset(bytes);
  repairChecksums(bytes);
  tryAsset(bytes);
  return 0;
}
