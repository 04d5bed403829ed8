#include "runtime/residency.h"

#include <algorithm>
#include <limits>

#include "material/check.h"

namespace loden::runtime {

uint32_t Residency::add(std::vector<PartDesc> parts) {
  uint32_t slot = static_cast<uint32_t>(materials_.size());
  if (free_slots_.empty()) {
    materials_.emplace_back();
  } else {
    slot = free_slots_.back();
    free_slots_.pop_back();
  }
  Material& material = materials_[slot];
  material = {};
  material.alive = true;
  uint64_t bytes = 0;
  for (const PartDesc& desc : parts) {
    bytes += desc.bytes;
    if (bytes <= options_.floor_bytes) ++material.floor_parts;
    material.published = std::max(material.published, desc.lambda_end);
    material.parts.push_back({desc});
  }
  return slot;
}

void Residency::remove(uint32_t slot) {
  LODEN_CHECK(materials_[slot].alive);
  for (uint32_t part = 0; part < materials_[slot].parts.size(); ++part) evict({slot, part});
  actions_.evict.clear();
  materials_[slot] = {};
  free_slots_.push_back(slot);
}

void Residency::demand(uint32_t slot, float lambda) {
  Material& material = materials_[slot];
  LODEN_CHECK(material.alive);
  const bool first = material.demanded_frame != frame_;
  material.demanded = first ? lambda : std::min(material.demanded, lambda);
  material.demanded_frame = frame_;
}

const Residency::Actions& Residency::advance(float seconds) {
  actions_.evict.clear();
  actions_.load.clear();
  settled_ = true;
  collectCandidates();
  chooseTargets();
  evictOverBudget();
  requestLoads();
  for (Material& material : materials_)
    if (material.alive && publish(material, seconds)) settled_ = false;
  ++frame_;
  return actions_;
}

void Residency::arrived(PartRef ref) {
  Part& part = at(ref);
  if (part.state != State::kLoading) return;  // evicted on the way
  part.state = State::kResident;
  --loading_;
  ++resident_parts_;
}

void Residency::failed(PartRef ref) {
  Part& part = at(ref);
  if (part.state != State::kLoading) return;
  part.state = State::kFailed;
  --loading_;
  committed_ -= part.desc.bytes;
}

void Residency::dropAll() {
  for (uint32_t slot = 0; slot < materials_.size(); ++slot)
    for (uint32_t part = 0; part < materials_[slot].parts.size(); ++part) evict({slot, part});
  actions_.evict.clear();
  for (Material& material : materials_)
    for (const Part& part : material.parts) material.published = std::max(material.published, part.desc.lambda_end);
}

// Leading parts that this frame's demand asks for, the floor at least.
uint32_t Residency::wantedParts(const Material& material) const {
  uint32_t count = material.floor_parts;
  if (material.demanded_frame != frame_) return count;
  for (uint32_t i = count; i < material.parts.size(); ++i)
    if (material.parts[i].desc.lambda_end > material.demanded) count = i + 1;
  return count;
}

// Wanted parts, the most needed first: floors, then coarse before fine. What is already there gets a head start,
// so that two materials of equal need do not push each other out in turns. Floors that are there need no place
// in the order: they come first anyway, which keeps thousands of unseen materials cheap.
void Residency::collectCandidates() {
  candidates_.clear();
  target_bytes_ = 0;
  for (uint32_t slot = 0; slot < materials_.size(); ++slot) {
    Material& material = materials_[slot];
    const uint32_t wanted = wantedParts(material);
    float rank = std::numeric_limits<float>::max();
    for (uint32_t i = 0; i < material.parts.size(); ++i) {
      Part& part = material.parts[i];
      part.targeted = false;
      if (i >= wanted) continue;
      part.last_wanted = frame_;
      if (part.state == State::kFailed) break;
      const float head_start = part.state == State::kAbsent ? 0 : options_.hysteresis_lambda;
      rank = std::min(rank, part.desc.lambda_end + head_start);
      if (i < material.floor_parts && part.state == State::kResident &&
          part.desc.bytes <= options_.budget_bytes - target_bytes_) {
        part.targeted = true;
        target_bytes_ += part.desc.bytes;
        continue;
      }
      candidates_.push_back({{slot, i}, i < material.floor_parts, rank});
    }
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    if (a.floor != b.floor) return a.floor;
    if (a.rank != b.rank) return a.rank > b.rank;
    return a.ref.slot != b.ref.slot ? a.ref.slot < b.ref.slot : a.ref.part < b.ref.part;
  });
}

// Marks as many candidates as the budget holds. A part that does not fit ends its material's list; smaller
// parts of others may still fit.
void Residency::chooseTargets() {
  for (const Candidate& candidate : candidates_) {
    Part& part = at(candidate.ref);
    const bool follows = candidate.ref.part == 0 || at({candidate.ref.slot, candidate.ref.part - 1}).targeted;
    if (!follows || part.desc.bytes > options_.budget_bytes - target_bytes_) continue;
    part.targeted = true;
    target_bytes_ += part.desc.bytes;
  }
  victims_.clear();
  next_victim_ = 0;
  for (uint32_t slot = 0; slot < materials_.size(); ++slot)
    for (uint32_t i = 0; i < materials_[slot].parts.size(); ++i) {
      const Part& part = materials_[slot].parts[i];
      if (part.state == State::kResident && !part.targeted) victims_.push_back({slot, i});
    }
  std::sort(victims_.begin(), victims_.end(), [this](PartRef a, PartRef b) {
    const int64_t age_a = at(a).last_wanted, age_b = at(b).last_wanted;
    if (age_a != age_b) return age_a < age_b;
    return a.slot != b.slot ? a.slot < b.slot : a.part > b.part;  // finest first
  });
}

// A smaller budget than before: out with what is not targeted, then with what is under way.
void Residency::evictOverBudget() {
  while (committed_ > options_.budget_bytes && next_victim_ < victims_.size()) evict(victims_[next_victim_++]);
  if (committed_ <= options_.budget_bytes) return;
  for (uint32_t slot = 0; slot < materials_.size(); ++slot)
    for (uint32_t i = 0; i < materials_[slot].parts.size(); ++i)
      if (materials_[slot].parts[i].state == State::kLoading && !materials_[slot].parts[i].targeted) evict({slot, i});
}

// Evicts least recently wanted parts until `bytes` fit. What was wanted a moment ago and is not now stays, unless
// something much coarser needs its room. What is wanted now and not targeted has lost its place already: the order
// of the candidates holds its head start, and a second bar here would keep a target out for good.
bool Residency::makeRoom(uint64_t bytes, const Candidate& wanted) {
  while (options_.budget_bytes - committed_ < bytes) {
    if (next_victim_ == victims_.size()) return false;
    const Part& victim = at(victims_[next_victim_]);
    const bool lingers = victim.last_wanted < frame_ && frame_ - victim.last_wanted < options_.hysteresis_frames;
    if (lingers && !wanted.floor && wanted.rank < victim.desc.lambda_end + 1) return false;
    evict(victims_[next_victim_++]);
  }
  return true;
}

// Makes way for what is wanted now: parts that are under way, but that nobody has wanted for a while.
void Residency::dropStaleLoads() {
  for (uint32_t slot = 0; slot < materials_.size(); ++slot)
    for (uint32_t i = 0; i < materials_[slot].parts.size(); ++i) {
      const Part& part = materials_[slot].parts[i];
      const bool stale = !part.targeted && frame_ - part.last_wanted >= options_.hysteresis_frames;
      if (part.state == State::kLoading && stale) evict({slot, i});
    }
}

void Residency::requestLoads() {
  for (const Candidate& candidate : candidates_) {
    Part& part = at(candidate.ref);
    if (part.state != State::kAbsent || !part.targeted) continue;
    settled_ = false;
    if (loading_ >= options_.max_loading) dropStaleLoads();
    if (loading_ >= options_.max_loading) return;
    if (!makeRoom(part.desc.bytes, candidate)) continue;  // smaller ones may fit: all targets do together
    part.state = State::kLoading;
    ++loading_;
    committed_ += part.desc.bytes;
    actions_.load.push_back(candidate.ref);
  }
}

void Residency::evict(PartRef ref) {
  Part& part = at(ref);
  if (part.state != State::kLoading && part.state != State::kResident) return;
  --(part.state == State::kLoading ? loading_ : resident_parts_);
  part.state = State::kAbsent;
  committed_ -= part.desc.bytes;
  actions_.evict.push_back(ref);
}

// Coarser at once where something is gone, finer at the fade's pace; true while fading.
bool Residency::publish(Material& material, float seconds) {
  float missing = 0;
  bool complete = true;
  for (const Part& part : material.parts) {
    complete = complete && part.state == State::kResident;
    if (!complete) missing = std::max(missing, part.desc.lambda_end);
  }
  const float faded = material.published - seconds * options_.fade_levels_per_second;
  material.published = std::max(missing, faded);
  return material.published > missing;
}

}  // namespace loden::runtime
