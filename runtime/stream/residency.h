// Residency: decides which parts of which materials are on the GPU. Policy only: no GL, no files, no threads.
//
// A material, which may also be a texture of an engine's own, is a list of parts, coarsest first, that are
// loaded in that order. In each frame call demand() for every visible material, then advance(), carry out the
// actions that it returns, and report back with arrived() or failed(). A part counts against the budget from
// its request on, so that the budget holds in every frame. The work per frame grows with the number of
// materials that are visible, loading or about to be released, not with the number of all materials.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace loden::runtime {

struct ResidencyOptions {
  uint64_t budget_bytes = 64u << 20;
  // The floor of a material is its leading parts of up to floor_bytes together. Floors stay resident whether
  // visible or not; those of materials that are not visible may take up to unseen_floor_share of the budget.
  uint64_t floor_bytes = 64u << 10;
  float unseen_floor_share = 0.25f;
  // How fast detail that arrives in view fades in: levels of detail per second.
  float fade_levels_per_second = 4;
  // The most levels of detail that fade in during one frame, however long the frame takes.
  float fade_levels_per_frame = 1.0f / 15;
  // A part stays resident for this many frames after it was last wanted.
  int hysteresis_frames = 8;
  // The advantage, in levels of detail, of a resident part over one that is not when both compete for room.
  float hysteresis_lambda = 0.5f;
  // A part that has not been wanted for longer than this is evicted even if there is room for it, in seconds.
  float release_seconds = 3;
  // The most parts that are loading at a time.
  int max_loading = 8;
};

struct PartDesc {
  uint64_t bytes = 0;    // size in GPU memory
  float lambda_end = 0;  // the part is needed at levels of detail below this lambda
  // The part only replaces an earlier part by a better one: detail is shown without it, and nothing is read
  // through it. It is requested once all parts before it in its list are resident, after all requests for
  // parts that do not refine, and only one such part of all materials is loading at a time.
  bool refines = false;
  // The part takes over from an earlier part; it is requested once all parts before it in its list are
  // resident.
  bool takes_over = false;
};

struct PartRef {
  uint32_t slot = 0;  // the material, as add() returned it
  uint32_t part = 0;  // index into the material's list of parts
  friend bool operator==(PartRef, PartRef) = default;
};

class Residency {
 public:
  explicit Residency(const ResidencyOptions& options) : options_(options) {}

  // Adds a material and returns its slot. Slots are reused after remove(). This is the only call that
  // allocates, also on behalf of all later calls; if it throws, nothing has changed.
  uint32_t add(std::vector<PartDesc> parts);
  // Forgets the material; its bytes are free at once.
  void remove(uint32_t slot);
  void setBudget(uint64_t bytes);

  // Says that in this frame something visible needs the material at `lambda`; of several calls the smallest
  // lambda counts.
  void demand(uint32_t slot, float lambda);

  // The actions of this frame; carry out evictions first. A part that is evicted while it is loading must be
  // dropped when it arrives.
  struct Actions {
    std::vector<PartRef> evict, load;
  };
  const Actions& advance(float seconds);

  // Reports that a requested part is now on the GPU (arrived) or never will be (failed); after a failure
  // nothing finer of the material is requested.
  void arrived(PartRef part);
  void failed(PartRef part);
  // Marks every part as absent, except for failed parts: for use after a lost context.
  void dropAll();
  // Ends all fades, so that everything that is resident is shown in full.
  void endFades();

  // The finest level of detail to show: that of the resident parts, faded in if they arrived in view. At most
  // lambda_end of the first part.
  float publishedLambda(uint32_t slot) const { return materials_[slot].published; }
  // How far, 0 to 1, a refining part has replaced the earlier one: 0 while it is not resident. If it arrives
  // in view, it rises to 1 at the rate at which lambda fades.
  float shownShare(PartRef part) const { return materials_[part.slot].parts[part.part].share; }
  bool resident(PartRef part) const {
    return materials_[part.slot].parts[part.part].state == State::kResident;
  }
  uint64_t committedBytes() const { return committed_; }
  int residentParts() const { return resident_parts_; }
  int loadingParts() const { return loading_; }
  // True if nothing is loading and nothing more can be requested.
  bool settled() const { return settled_ && loading_ == 0; }
  // The slots that the last advance() visited; state and published lambda of all other slots are as they were
  // before that call.
  std::span<const uint32_t> active() const { return active_; }

 private:
  enum class State : uint8_t { kAbsent, kLoading, kResident, kFailed };
  struct Part {
    PartDesc desc;
    State state = State::kAbsent;
    float share = 0;            // shownShare
    bool targeted = false;      // this frame's targets include the part
    int64_t last_wanted = -1;   // frame number
    double last_wanted_at = 0;  // seconds
  };
  struct Material {
    bool alive = false;
    bool active = false;  // listed in active_
    // Nothing about the material changes until it is demanded or the budget has room for more floors.
    bool at_rest = false;
    std::vector<Part> parts;
    uint32_t floor_parts = 0;
    uint32_t wanted_parts = 0;  // how many parts from the front are wanted in this frame
    float demanded = 0;
    int64_t demanded_frame = -1;
    float published = 0;
  };
  struct Candidate {
    PartRef ref;
    // Lower comes first: floors of visible materials, then detail, then refinements, then floors of materials
    // that are not visible, which have a share of the budget of their own.
    int rank_class;
    // Higher comes first: by how many levels the material is shown too coarse without the part.
    float rank;
  };

  Part& at(PartRef ref) { return materials_[ref.slot].parts[ref.part]; }
  void reserveFor(size_t more_parts);
  static float tooCoarseWithout(const Part& part, const Material& material);
  bool followsTargets(PartRef ref) const;
  void activate(uint32_t slot);
  void deactivateWhatRests();
  uint64_t residentBytes(const Material& material) const;
  bool seen(const Material& material) const { return material.demanded_frame == frame_; }
  uint32_t wantedParts(const Material& material);
  void collectCandidates();
  void chooseTargets();
  bool mayLoad(PartRef ref) const;
  bool makeRoom(uint64_t bytes, const Candidate& wanted);
  void evictOverBudget();
  void releaseUnwanted();
  void dropStaleLoads();
  void requestLoads();
  void stopLoading(Part& part);
  void evict(PartRef ref);
  static float missingLambda(const Material& material);
  void publish(Material& material, float seconds);
  bool rests(const Material& material) const;

  ResidencyOptions options_;
  std::vector<Material> materials_;
  size_t parts_ = 0;  // number of parts of all materials
  std::vector<uint32_t> free_slots_;
  std::vector<uint32_t> active_;
  bool activate_all_ = false;
  std::vector<Candidate> candidates_;
  std::vector<PartRef> victims_;  // resident parts that are not targets, least recently wanted first
  size_t next_victim_ = 0;
  Actions actions_;
  uint64_t committed_ = 0, target_bytes_ = 0;
  uint64_t resting_bytes_ = 0;       // resident bytes of materials that are not active
  uint64_t unseen_floor_bytes_ = 0;  // bytes of unseen floors among this frame's targets
  // refining_: how many of the loading parts are refinements.
  int loading_ = 0, refining_ = 0, resident_parts_ = 0;
  int64_t frame_ = 0;
  double now_ = 0;  // seconds
  bool settled_ = true;
};

}  // namespace loden::runtime
