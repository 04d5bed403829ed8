// Which parts of which materials are on the GPU: policy only, no GL, no files, no threads.
//
// A material is a list of parts, coarsest first, that arrive in that order. Each frame: demand() for what is
// visible, then advance(), whose actions the caller carries out, reporting back with arrived() or failed().
// Parts count against the budget from the request on, so the budget holds on every frame. A frame's work
// grows with the materials that are seen, under way or about to be released, not with all of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace loden::runtime {

struct ResidencyOptions {
  uint64_t budget_bytes = 64u << 20;
  // Leading parts up to this many bytes stay resident, visible or not; of what is not visible, as many as
  // this share of the budget holds.
  uint64_t floor_bytes = 64u << 10;
  float unseen_floor_share = 0.25f;
  float fade_levels_per_second = 4;         // of detail that arrives in view
  float fade_levels_per_frame = 1.0f / 15;  // at most, however long a frame takes
  int hysteresis_frames = 8;                // a part that is no longer wanted stays this many frames
  float hysteresis_lambda = 0.5f;           // head start of what is resident over what is not, levels
  float release_seconds = 3;                // what nobody has wanted for longer goes even where there is room
  int max_loading = 8;                      // parts asked for at once
};

struct PartDesc {
  uint64_t bytes = 0;    // of GPU memory
  float lambda_end = 0;  // the part is needed where lambda is below
  // It only replaces an earlier part by a better one: detail is shown without it, and nothing reads through
  // it. It is asked for when what stands before it is there, one of all materials at a time, after all that
  // does not refine.
  bool refines = false;
  // It takes over from an earlier part: asked for when what stands before it is there.
  bool takes_over = false;
};

struct PartRef {
  uint32_t slot = 0;  // of the material
  uint32_t part = 0;  // index into its list
  friend bool operator==(PartRef, PartRef) = default;
};

class Residency {
 public:
  explicit Residency(const ResidencyOptions& options) : options_(options) {}

  // Slots are reused after remove(). The one call that allocates, for all that follow: where it throws,
  // nothing has changed.
  uint32_t add(std::vector<PartDesc> parts);
  // Forgets the material; its bytes are free at once.
  void remove(uint32_t slot);
  void setBudget(uint64_t bytes);

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
  // Shows what is resident without a fade.
  void endFades();

  // Detail below this is not to be shown: what is resident, faded in where it arrived in view. lambda_end of
  // the first part at most.
  float publishedLambda(uint32_t slot) const { return materials_[slot].published; }
  // How far a part that refines has taken the place of what it replaces: 0 where it is not resident, rising
  // to 1 where it arrived in view, by as much as lambda would change.
  float shownShare(PartRef part) const { return materials_[part.slot].parts[part.part].share; }
  bool resident(PartRef part) const {
    return materials_[part.slot].parts[part.part].state == State::kResident;
  }
  uint64_t committedBytes() const { return committed_; }
  int residentParts() const { return resident_parts_; }
  int loadingParts() const { return loading_; }
  // Nothing is under way, and nothing can be asked for.
  bool settled() const { return settled_ && loading_ == 0; }
  // Slots that the last advance() looked at; no other's state or published lambda has changed since the one
  // before.
  std::span<const uint32_t> active() const { return active_; }

 private:
  enum class State : uint8_t { kAbsent, kLoading, kResident, kFailed };
  struct Part {
    PartDesc desc;
    State state = State::kAbsent;
    float share = 0;            // shownShare
    bool targeted = false;      // in this frame's target set
    int64_t last_wanted = -1;   // frame
    double last_wanted_at = 0;  // seconds
  };
  struct Material {
    bool alive = false;
    bool active = false;  // listed in active_
    bool at_rest =
        false;  // nothing of it will change until it is demanded or the budget has room for more floors
    std::vector<Part> parts;
    uint32_t floor_parts = 0;
    uint32_t wanted_parts = 0;  // leading ones, this frame
    float demanded = 0;
    int64_t demanded_frame = -1;
    float published = 0;
  };
  struct Candidate {
    PartRef ref;
    int rank_class;  // lower comes first: floors, detail, refinements, floors of what is not seen, which have
                     // their own share
    float rank;  // higher comes first: by how many levels the material is shown too coarse without the part
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
  size_t parts_ = 0;  // of all materials
  std::vector<uint32_t> free_slots_;
  std::vector<uint32_t> active_;
  bool activate_all_ = false;
  std::vector<Candidate> candidates_;
  std::vector<PartRef> victims_;  // resident, not targeted, least recently wanted first
  size_t next_victim_ = 0;
  Actions actions_;
  uint64_t committed_ = 0, target_bytes_ = 0;
  uint64_t resting_bytes_ = 0;                           // resident, of materials that are not active
  uint64_t unseen_floor_bytes_ = 0;                      // of this frame's targets
  int loading_ = 0, refining_ = 0, resident_parts_ = 0;  // refining_: of those loading
  int64_t frame_ = 0;
  double now_ = 0;  // seconds
  bool settled_ = true;
};

}  // namespace loden::runtime
