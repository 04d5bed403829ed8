#include "runtime/stream/residency.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "material/base/check.h"

namespace loden::runtime {

// Room in every list for what may stand in it.
void Residency::reserveFor(size_t more_parts) {
  const size_t slots = materials_.size() + 1, parts = parts_ + more_parts;
  if (materials_.capacity() < slots) materials_.reserve(2 * slots);
  const auto reserve = [](auto& list, size_t count) {
    if (list.capacity() < count) list.reserve(2 * count);
  };
  reserve(free_slots_, slots);
  reserve(active_, slots);
  reserve(candidates_, parts);
  reserve(victims_, parts);
  reserve(actions_.evict, parts);
  reserve(actions_.load, static_cast<size_t>(std::max(options_.max_loading, 0)));
}

uint32_t Residency::add(std::vector<PartDesc> parts) {
  Material material;
  material.alive = true;
  material.parts.reserve(parts.size());
  uint64_t bytes = 0;
  for (const PartDesc& desc : parts) {
    LODEN_CHECK(!desc.refines || !material.parts.empty());
    bytes += desc.bytes;
    if (bytes <= options_.floor_bytes && !desc.refines && material.floor_parts == material.parts.size())
      ++material.floor_parts;
    material.published = std::max(material.published, desc.lambda_end);
    material.parts.push_back({desc});
  }
  reserveFor(parts.size());
  uint32_t slot = static_cast<uint32_t>(materials_.size());
  if (free_slots_.empty()) {
    materials_.emplace_back();
  } else {
    slot = free_slots_.back();
    free_slots_.pop_back();
  }
  parts_ += parts.size();
  materials_[slot] = std::move(material);
  activate(slot);
  return slot;
}

void Residency::remove(uint32_t slot) {
  LODEN_CHECK(materials_[slot].alive);
  activate(slot);
  actions_.evict.clear();
  evict({slot, 0});
  actions_.evict.clear();
  std::erase(active_, slot);
  parts_ -= materials_[slot].parts.size();
  materials_[slot] = {};
  free_slots_.push_back(slot);
  activate_all_ = true;
}

void Residency::setBudget(uint64_t bytes) {
  options_.budget_bytes = bytes;
  activate_all_ = true;
}

void Residency::demand(uint32_t slot, float lambda) {
  Material& material = materials_[slot];
  LODEN_CHECK(material.alive);
  const bool first = !seen(material);
  material.demanded = first ? lambda : std::min(material.demanded, lambda);
  material.demanded_frame = frame_;
  activate(slot);
}

const Residency::Actions& Residency::advance(float seconds) {
  actions_.evict.clear();
  actions_.load.clear();
  settled_ = true;
  now_ += seconds;
  deactivateWhatRests();
  collectCandidates();
  chooseTargets();
  evictOverBudget();
  releaseUnwanted();
  requestLoads();
  for (const uint32_t slot : active_) {
    publish(materials_[slot], seconds);
    materials_[slot].at_rest = rests(materials_[slot]);
  }
  ++frame_;
  return actions_;
}

void Residency::arrived(PartRef ref) {
  Part& part = at(ref);
  if (part.state != State::kLoading) return;  // evicted on the way
  stopLoading(part);
  part.state = State::kResident;
  ++resident_parts_;
}

void Residency::failed(PartRef ref) {
  Part& part = at(ref);
  if (part.state != State::kLoading) return;
  stopLoading(part);
  part.state = State::kFailed;
  committed_ -= part.desc.bytes;
}

void Residency::dropAll() {
  actions_.evict.clear();
  for (uint32_t slot = 0; slot < materials_.size(); ++slot) {
    if (!materials_[slot].alive) continue;
    activate(slot);
    evict({slot, 0});
    for (const Part& part : materials_[slot].parts)
      materials_[slot].published = std::max(materials_[slot].published, part.desc.lambda_end);
  }
  actions_.evict.clear();
}

void Residency::endFades() {
  for (const uint32_t slot : active_) {
    materials_[slot].published = missingLambda(materials_[slot]);
    for (Part& part : materials_[slot].parts) part.share = part.state == State::kResident ? 1 : 0;
  }
}

uint64_t Residency::residentBytes(const Material& material) const {
  uint64_t bytes = 0;
  for (const Part& part : material.parts)
    if (part.state == State::kResident) bytes += part.desc.bytes;
  return bytes;
}

void Residency::activate(uint32_t slot) {
  Material& material = materials_[slot];
  if (material.active) return;
  material.active = true;
  material.at_rest = false;
  active_.push_back(slot);
  resting_bytes_ -= residentBytes(material);
}

// At the start of a frame, so that active() still lists what came to rest in the last one.
void Residency::deactivateWhatRests() {
  if (std::exchange(activate_all_, false)) {
    for (uint32_t slot = 0; slot < materials_.size(); ++slot) {
      if (!materials_[slot].alive) continue;
      activate(slot);
      materials_[slot].at_rest = false;
    }
  }
  std::erase_if(active_, [this](uint32_t slot) {
    Material& material = materials_[slot];
    if (!material.at_rest || seen(material)) return false;
    material.active = false;
    resting_bytes_ += residentBytes(material);
    return true;
  });
}

// Leading parts that this frame's demand asks for: the floor, where nobody looks as far as the share for that
// holds it.
uint32_t Residency::wantedParts(const Material& material) {
  uint32_t count = 0;
  if (seen(material)) {
    count = material.floor_parts;
    for (uint32_t i = count; i < material.parts.size(); ++i)
      if (material.parts[i].desc.lambda_end > material.demanded) count = i + 1;
    return count;
  }
  const auto share = uint64_t(double(options_.budget_bytes) * double(options_.unseen_floor_share));
  const auto fits = [&](uint64_t bytes) { return unseen_floor_bytes_ + bytes <= share; };
  for (; count < material.floor_parts && fits(material.parts[count].desc.bytes); ++count)
    unseen_floor_bytes_ += material.parts[count].desc.bytes;
  return count;
}

// Wanted parts, the most needed first: floors, then what brings a material nearer to its demand, the furthest
// from it first, then refinements. What is already there gets a head start, so that two materials of equal
// need do not push each other out in turns. Floors that are there need no place in the order: they come first
// anyway. Nor do those of what is not seen, whose share is theirs: they are only read last.
void Residency::collectCandidates() {
  candidates_.clear();
  target_bytes_ = unseen_floor_bytes_ = resting_bytes_;
  for (const uint32_t slot : active_) {
    Material& material = materials_[slot];
    material.wanted_parts = wantedParts(material);
    float rank = std::numeric_limits<float>::max();
    bool broken = false;  // what follows a part that failed is of no use
    for (uint32_t i = 0; i < material.parts.size(); ++i) {
      Part& part = material.parts[i];
      part.targeted = false;
      if (i >= material.wanted_parts || broken) continue;
      part.last_wanted = frame_;
      part.last_wanted_at = now_;
      if (part.state == State::kFailed && part.desc.refines) continue;
      broken = part.state == State::kFailed;
      if (broken) continue;
      const float head_start = part.state == State::kAbsent ? 0 : options_.hysteresis_lambda;
      const float own_rank = std::min(rank, tooCoarseWithout(part, material) + head_start);
      if (!part.desc.refines) rank = own_rank;
      const bool floor = i < material.floor_parts;
      if (floor && (part.state == State::kResident || !seen(material)) &&
          part.desc.bytes <= options_.budget_bytes - target_bytes_) {
        part.targeted = true;
        target_bytes_ += part.desc.bytes;
        if (part.state == State::kResident) continue;
      }
      const int rank_class = !seen(material) ? 3 : floor ? 0 : part.desc.refines ? 2 : 1;
      candidates_.push_back({{slot, i}, rank_class, own_rank});
    }
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    if (a.rank_class != b.rank_class) return a.rank_class < b.rank_class;
    if (a.rank != b.rank) return a.rank > b.rank;
    return a.ref.slot != b.ref.slot ? a.ref.slot < b.ref.slot : a.ref.part < b.ref.part;
  });
}

// Levels between what is shown without the part and what was asked for last.
float Residency::tooCoarseWithout(const Part& part, const Material& material) {
  return part.desc.lambda_end - std::max(material.demanded, 0.0f);
}

// Whether all is targeted that the part reads through.
bool Residency::followsTargets(PartRef ref) const {
  const std::vector<Part>& parts = materials_[ref.slot].parts;
  for (uint32_t i = ref.part; i-- > 0;)
    if (!parts[i].desc.refines) return parts[i].targeted;
  return true;
}

// Marks as many candidates as the budget holds. A part that does not fit ends its material's list, if it does
// not refine; smaller parts of others may still fit.
void Residency::chooseTargets() {
  for (const Candidate& candidate : candidates_) {
    Part& part = at(candidate.ref);
    if (part.targeted || !followsTargets(candidate.ref) ||
        part.desc.bytes > options_.budget_bytes - target_bytes_)
      continue;
    part.targeted = true;
    target_bytes_ += part.desc.bytes;
  }
  victims_.clear();
  next_victim_ = 0;
  for (const uint32_t slot : active_)
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
  while (committed_ > options_.budget_bytes && next_victim_ < victims_.size())
    evict(victims_[next_victim_++]);
  if (committed_ <= options_.budget_bytes) return;
  for (const uint32_t slot : active_)
    for (uint32_t i = 0; i < materials_[slot].parts.size(); ++i)
      if (materials_[slot].parts[i].state == State::kLoading && !materials_[slot].parts[i].targeted)
        evict({slot, i});
}

// One part a frame: giving back a texture takes time, and nobody waits for the room.
void Residency::releaseUnwanted() {
  if (next_victim_ == victims_.size()) return;
  const PartRef oldest = victims_[next_victim_];
  if (now_ - at(oldest).last_wanted_at <= options_.release_seconds) return;
  evict(oldest);
  ++next_victim_;
}

// Evicts least recently wanted parts until `bytes` fit. What was wanted a moment ago and is not now stays,
// unless something much coarser needs its room. What is wanted now and not targeted has lost its place
// already: the order of the candidates holds its head start, and a second bar here would keep a target out
// for good.
bool Residency::makeRoom(uint64_t bytes, const Candidate& wanted) {
  while (options_.budget_bytes - committed_ < bytes) {
    if (next_victim_ == victims_.size()) return false;
    const Part& victim = at(victims_[next_victim_]);
    const float victim_rank = tooCoarseWithout(victim, materials_[victims_[next_victim_].slot]);
    const bool lingers =
        victim.last_wanted < frame_ && frame_ - victim.last_wanted < options_.hysteresis_frames;
    if (lingers && wanted.rank_class > 0 && wanted.rank < victim_rank + 1) return false;
    evict(victims_[next_victim_++]);
  }
  return true;
}

// Makes way for what is wanted now: parts that are under way, but that nobody has wanted for a while.
void Residency::dropStaleLoads() {
  for (const uint32_t slot : active_)
    for (uint32_t i = 0; i < materials_[slot].parts.size(); ++i) {
      const Part& part = materials_[slot].parts[i];
      const bool stale = !part.targeted && frame_ - part.last_wanted >= options_.hysteresis_frames;
      if (part.state == State::kLoading && stale) evict({slot, i});
    }
}

bool Residency::mayLoad(PartRef ref) const {
  const std::vector<Part>& parts = materials_[ref.slot].parts;
  const Part& part = parts[ref.part];
  if (part.state != State::kAbsent || !part.targeted) return false;
  if (part.desc.refines && refining_ > 0) return false;
  const auto before = parts.begin() + ref.part;
  return !(part.desc.refines || part.desc.takes_over) ||
         std::all_of(parts.begin(), before, [](const Part& earlier) {
           return earlier.desc.refines || earlier.state == State::kResident;
         });
}

void Residency::requestLoads() {
  for (const Candidate& candidate : candidates_) {
    Part& part = at(candidate.ref);
    if (!mayLoad(candidate.ref)) continue;
    settled_ = false;
    if (loading_ >= options_.max_loading) dropStaleLoads();
    if (loading_ >= options_.max_loading) return;
    if (!makeRoom(part.desc.bytes, candidate)) continue;  // smaller ones may fit: all targets do together
    part.state = State::kLoading;
    ++loading_;
    refining_ += part.desc.refines;
    committed_ += part.desc.bytes;
    actions_.load.push_back(candidate.ref);
  }
}

void Residency::stopLoading(Part& part) {
  --loading_;
  refining_ -= part.desc.refines;
}

// With what comes after it, which reads through it unless it refines, and may still be under way.
void Residency::evict(PartRef ref) {
  std::vector<Part>& parts = materials_[ref.slot].parts;
  if (parts.empty()) return;
  const uint32_t end = parts[ref.part].desc.refines ? ref.part + 1 : uint32_t(parts.size());
  for (uint32_t i = end; i-- > ref.part;) {
    Part& part = parts[i];
    if (part.state != State::kLoading && part.state != State::kResident) continue;
    if (part.state == State::kLoading)
      stopLoading(part);
    else
      --resident_parts_;
    part.state = State::kAbsent;
    part.share = 0;
    committed_ -= part.desc.bytes;
    actions_.evict.push_back({ref.slot, i});
  }
}

// The lambda below which something is missing.
float Residency::missingLambda(const Material& material) {
  float missing = 0;
  bool complete = true;
  for (const Part& part : material.parts) {
    if (part.desc.refines) continue;
    complete = complete && part.state == State::kResident;
    if (!complete) missing = std::max(missing, part.desc.lambda_end);
  }
  return missing;
}

// Coarser at once where something is gone, finer at the fade's pace where somebody could see the difference.
void Residency::publish(Material& material, float seconds) {
  const float missing = missingLambda(material);
  const float step = std::min(seconds * options_.fade_levels_per_second, options_.fade_levels_per_frame);
  material.published = seen(material) ? std::max(missing, material.published - step) : missing;
  for (Part& part : material.parts)
    if (part.desc.refines && part.state == State::kResident)
      part.share = seen(material) ? std::min(part.share + step, 1.0f) : 1;
}

// Unseen, and holds what is wanted of it, as far as the file gives it, and no more.
bool Residency::rests(const Material& material) const {
  if (seen(material)) return false;
  bool broken = false;
  for (uint32_t i = 0; i < material.parts.size(); ++i) {
    const State state = material.parts[i].state;
    broken = broken || (state == State::kFailed && !material.parts[i].desc.refines);
    const bool wanted = i < material.wanted_parts && !broken;
    if (state == State::kLoading || state == (wanted ? State::kAbsent : State::kResident)) return false;
  }
  return true;
}

}  // namespace loden::runtime
