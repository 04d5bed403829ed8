// Which parts of which materials are on the GPU: policy only, no GL, no files, no threads.
//
// A material is a list of parts, coarsest first, that arrive in that order. Each frame: demand() for what is
// visible, then advance(), whose actions the caller carries out, reporting back with arrived() or failed().
// Parts count against the budget from the request on, so the budget holds on every frame.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace loden::runtime {

struct ResidencyOptions {
  uint64_t budget_bytes = 64u << 20;
  uint64_t floor_bytes = 64u << 10;  // leading parts up to this many bytes stay resident, visible or not
  float fade_levels_per_second = 2.5f;  // of detail that has arrived
  int hysteresis_frames = 8;         // a part that is no longer wanted stays this many frames
  float hysteresis_lambda = 0.5f;    // head start of what is resident over what is not, levels
  int max_loading = 8;               // parts asked for at once
};

struct PartDesc {
  uint64_t bytes = 0;    // of GPU memory
  float lambda_end = 0;  // the part is needed where lambda is below
};

struct PartRef {
  uint32_t slot = 0;  // of the material
  uint32_t part = 0;  // index into its list
  friend bool operator==(PartRef, PartRef) = default;
};

class Residency {
 public:
  explicit Residency(const ResidencyOptions& options) : options_(options) {}

  // Slots are reused after remove().
  uint32_t add(std::vector<PartDesc> parts);
  // Forgets the material; its bytes are free at once.
  void remove(uint32_t slot);
  void setBudget(uint64_t bytes) { options_.budget_bytes = bytes; }

  // This frame something visible asks for the material at `lambda`; the smallest of several counts.
  void demand(uint32_t slot, float lambda);

  // What to do now, evictions first. Evicting a part that is still loading means to drop it on arrival.
  struct Actions {
    std::vector<PartRef> evict, load;
  };
  const Actions& advance(float seconds);

  // A part asked for is on the GPU, or will never be: then nothing finer of the material is asked for.
  void arrived(PartRef part);
  void failed(PartRef part);
  // Everything is absent again, failed parts excepted: after a lost context.
  void dropAll();

  // Detail below this is not to be shown: what is resident, faded in. lambda_end of the first part at most.
  float publishedLambda(uint32_t slot) const { return materials_[slot].published; }
  bool resident(PartRef part) const { return materials_[part.slot].parts[part.part].state == State::kResident; }
  uint64_t committedBytes() const { return committed_; }
  int residentParts() const { return resident_parts_; }
  int loadingParts() const { return loading_; }
  // Nothing is under way, nothing can be asked for, and every fade has ended.
  bool settled() const { return settled_ && loading_ == 0; }

 private:
  enum class State : uint8_t { kAbsent, kLoading, kResident, kFailed };
  struct Part {
    PartDesc desc;
    State state = State::kAbsent;
    bool targeted = false;     // in this frame's target set
    int64_t last_wanted = -1;  // frame
  };
  struct Material {
    bool alive = false;
    std::vector<Part> parts;
    uint32_t floor_parts = 0;
    float demanded = 0;
    int64_t demanded_frame = -1;
    float published = 0;
  };
  struct Candidate {
    PartRef ref;
    bool floor;
    float rank;  // higher comes first
  };

  Part& at(PartRef ref) { return materials_[ref.slot].parts[ref.part]; }
  uint32_t wantedParts(const Material& material) const;
  void collectCandidates();
  void chooseTargets();
  bool makeRoom(uint64_t bytes, const Candidate& wanted);
  void evictOverBudget();
  void dropStaleLoads();
  void requestLoads();
  void evict(PartRef ref);
  bool publish(Material& material, float seconds);

  ResidencyOptions options_;
  std::vector<Material> materials_;
  std::vector<uint32_t> free_slots_;
  std::vector<Candidate> candidates_;
  std::vector<PartRef> victims_;  // resident, not targeted, least recently wanted first
  size_t next_victim_ = 0;
  Actions actions_;
  uint64_t committed_ = 0, target_bytes_ = 0;
  int loading_ = 0, resident_parts_ = 0;
  int64_t frame_ = 0;
  bool settled_ = true;
};

}  // namespace loden::runtime
