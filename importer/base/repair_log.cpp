#include "importer/base/repair_log.h"

#include <cmath>
#include <cstdio>
#include <vector>

#include "material/base/check.h"

namespace loden::importer {

void RepairLog::add(const std::string& part, uint64_t count, const std::string& first) {
  if (count == 0) return;
  const std::lock_guard lock(mutex_);
  entries_.try_emplace(part, Entry{count, first});
}

uint64_t RepairLog::count() const {
  const std::lock_guard lock(mutex_);
  uint64_t sum = 0;
  for (const auto& [part, entry] : entries_) sum += entry.count;
  return sum;
}

std::string RepairLog::first() const {
  const std::lock_guard lock(mutex_);
  return entries_.empty() ? std::string() : entries_.begin()->first + ": " + entries_.begin()->second.first;
}

NonFinite findNonFinite(std::span<const float> values) {
  NonFinite found;
  for (size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) && found.count++ == 0) found.first = i;
  return found;
}

std::string placeOf(size_t index, const MapShape& shape, const std::string& layer) {
  const size_t texel = index / size_t(shape.channels), texels = size_t(shape.width) * size_t(shape.height);
  const size_t inside = texel % texels;
  const std::string place = "texel (" + std::to_string(inside % size_t(shape.width)) + ", " +
                            std::to_string(inside / size_t(shape.width)) + ")";
  return layer.empty() ? place : layer + " " + std::to_string(texel / texels) + ", " + place;
}

namespace {

// Mean over the finite neighbours of a value; NaN if it has none.
float meanOfNeighbours(std::span<const float> values, const MapShape& s, size_t index) {
  const size_t channels = size_t(s.channels), texels = size_t(s.width) * size_t(s.height);
  const size_t texel = index / channels, layer = texel / texels * texels;
  const int x = static_cast<int>(texel % texels % size_t(s.width)),
            y = static_cast<int>(texel % texels / size_t(s.width));
  double sum = 0;
  int count = 0;
  for (int k = 0; k < 9; ++k) {
    const int i = (x + k % 3 - 1 + s.width) % s.width, j = (y + k / 3 - 1 + s.height) % s.height;
    const float value =
        values[(layer + size_t(j) * size_t(s.width) + size_t(i)) * channels + index % channels];
    if (std::isfinite(value)) sum += double(value), ++count;
  }
  return count > 0 ? static_cast<float>(sum / count) : std::nanf("");
}

}  // namespace

NonFinite repairNonFinite(std::span<float> values, const MapShape& shape) {
  LODEN_CHECK_EQ(values.size(),
                 size_t(shape.layers) * size_t(shape.width) * size_t(shape.height) * size_t(shape.channels));
  const NonFinite found = findNonFinite(values);
  std::vector<size_t> left;
  for (size_t i = found.first; found.count > 0 && i < values.size(); ++i)
    if (!std::isfinite(values[i])) left.push_back(i);
  while (!left.empty()) {
    std::vector<std::pair<size_t, float>> repaired;
    std::vector<size_t> still;
    for (const size_t i : left) {
      const float mean = meanOfNeighbours(values, shape, i);
      if (std::isfinite(mean))
        repaired.emplace_back(i, mean);
      else
        still.push_back(i);
    }
    // What has no finite value anywhere in its layer.
    if (repaired.empty())
      for (const size_t i : still) values[i] = 0;
    for (const auto& [i, mean] : repaired) values[i] = mean;
    left = repaired.empty() ? std::vector<size_t>() : std::move(still);
  }
  return found;
}

}  // namespace loden::importer
