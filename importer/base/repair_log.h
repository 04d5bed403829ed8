// Finds values of an input that are not finite, repairs them on demand, and records the repairs for a report.
#pragma once

#include <cstdint>
#include <map>
#include <mutex>
#include <span>
#include <string>

namespace loden::importer {

// The repairs made in one input, over all its maps. Thread safe.
class RepairLog {
 public:
  // Records that `count` values or vertices of the part were repaired, the first of them at `first`. A part
  // that is read again counts once. Parts are reported in the order of their names.
  void add(const std::string& part, uint64_t count, const std::string& first);
  uint64_t count() const;
  std::string first() const;  // "part: place"; empty if nothing was repaired

 private:
  struct Entry {
    uint64_t count = 0;
    std::string first;
  };
  mutable std::mutex mutex_;
  std::map<std::string, Entry> entries_;
};

// The shape of a periodic map or of a stack of them: values are [layer][row][column][channel].
struct MapShape {
  int layers = 1, width = 0, height = 0, channels = 1;
};
struct NonFinite {
  uint64_t count = 0;
  size_t first = 0;  // index of the first value; meaningless if count is 0
};
// The number of values that are not finite, and the first of them.
NonFinite findNonFinite(std::span<const float> values);
// The place of a value in words: "light 3, texel (4, 5)". `layer` names what the layers are; empty: there is
// one layer.
std::string placeOf(size_t index, const MapShape& shape, const std::string& layer);
// Replaces each value that is not finite by the mean of the finite values of its layer and channel among its
// eight neighbours (the map wraps around), from the border of a damaged area inwards; by 0 if the layer has
// no finite value. Returns what findNonFinite would have returned before.
NonFinite repairNonFinite(std::span<float> values, const MapShape& shape);

}  // namespace loden::importer
