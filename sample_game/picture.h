// What the window shows of the world, however long a frame takes: coarse while anything changes, and refined
// piece by piece at rest, so that the window answers all the while.
#pragma once

#include <optional>
#include <vector>

#include "runtime/gl/gl_target.h"
#include "sample_game/world.h"

namespace loden::walk {

// What is drawn of the materials: to compare one with another.
enum class Look { kDefault, kSurface, kParallax, kFallback, kTruth };
inline constexpr const char* kLookNames[] = {"Loden", "Loden without shadows in the tile",
                                             "parallax occlusion mapping", "glTF's own materials",
                                             "traced truth"};

// Left of the border one look, right of it the other.
struct Wipe {
  bool on = false;
  Look left = Look::kFallback, right = Look::kDefault;
  float border = 0.5f;  // share of the width
  friend bool operator==(const Wipe&, const Wipe&) = default;
};

// To the far side of the scene; near enough planes for a room, in proportion for what is larger, nearer
// before what is closer.
runtime::DepthRange depthRange(const runtime::Bounds& all, const Camera& camera);

class Picture {
 public:
  explicit Picture(World& world) : world_(world) {}

  // Makes room for the first picture; draws nothing.
  Status begin(glm::ivec2 size) { return makeShown(size); }
  // Draws as much as fits into about a tenth of a second, at least something. Whoever changes what is seen,
  // but for camera and wipe, calls changed() before.
  Status advance(const Camera& camera, glm::ivec2 size, const Wipe& wipe, float seconds);
  void changed() { changed_ = true; }
  // Copies the picture to the window.
  void show() const;

  // Whether the truth is of what the last picture shows; the default look stands in its place otherwise.
  bool showsTruth() const;
  // Nothing is left to do until something changes.
  bool whole() const { return whole_ && !streaming_; }
  // The picture is refined, so that what is counted is a part of it.
  bool refining() const { return !whole_; }
  double lastMs() const { return last_ms_; }    // of the last call
  double wholeMs() const { return whole_ms_; }  // what all of it takes, as far as is known
  const runtime::FrameStats& stats() const { return stats_; }
  // sRGB codes, first row at the top.
  std::vector<glm::u8vec4> codes() const { return runtime::readCodes(*shown_); }
  glm::ivec2 size() const { return shown_ ? shown_->size : glm::ivec2(0); }

 private:
  struct Piece {
    glm::ivec2 from{0}, to{0};
    Look look = Look::kDefault;
  };
  Status makeShown(glm::ivec2 size);
  // The wipe's two halves, or all.
  std::vector<Piece> halves(const Wipe& wipe) const;
  // Draws a piece with a pixel for each `coarse` x `coarse` of it.
  Status draw(const Piece& piece, int coarse);
  Status drawTruth(const Piece& piece);
  Status drawCoarse(const Wipe& wipe);
  Status drawNextPieces(const Wipe& wipe);
  void cutIntoPieces(const Wipe& wipe);

  World& world_;
  std::optional<runtime::RenderTarget> shown_, part_;
  std::optional<runtime::RenderTarget> truth_;  // of the shown picture's size
  runtime::View view_;
  runtime::FrameStats stats_;
  std::vector<Piece> left_;  // of the picture that are coarse still, last first
  Camera camera_;
  Wipe wipe_;
  uint64_t detail_ = 0;
  bool changed_ = true, whole_ = false, streaming_ = true;
  double last_ms_ = 0;
  double ns_per_pixel_ = 0;  // of the last pieces at full resolution; 0: not known
  double whole_ms_ = 0;
};

}  // namespace loden::walk
