// The picture in the window. A frame may take long; so the picture is drawn coarsely while anything changes,
// and refined piece by piece when nothing does, so that the window always answers.
#pragma once

#include <optional>
#include <vector>

#include "runtime/gl/gl_target.h"
#include "sample_game/world.h"

namespace loden::walk {

// Ways to draw the materials, which the wipe compares.
enum class Look { kDefault, kSurface, kParallax, kFallback, kTruth };
inline constexpr const char* kLookNames[] = {"Loden", "Loden without shadows in the tile",
                                             "parallax occlusion mapping", "glTF's own materials",
                                             "traced truth"};

// A picture in two halves: one look to the left of the border, another to the right of it.
struct Wipe {
  bool on = false;
  Look left = Look::kFallback, right = Look::kDefault;
  float border = 0.5f;  // where the border is, as a share of the width
  friend bool operator==(const Wipe&, const Wipe&) = default;
};

// The range of depths of a picture: up to the far side of the scene. The near plane is close enough for a
// room; it is further away in larger scenes, and closer if the camera is close to the scene.
runtime::DepthRange depthRange(const runtime::Bounds& all, const Camera& camera);

class Picture {
 public:
  explicit Picture(World& world) : world_(world) {}

  // Allocates the first picture, and draws nothing.
  Status begin(glm::ivec2 size) { return makeShown(size); }
  // Draws as much as fits into about a tenth of a second, but at least one piece. Changes of camera and wipe
  // are noticed; whoever changes anything else that is seen must call changed() before.
  Status advance(const Camera& camera, glm::ivec2 size, const Wipe& wipe, float seconds);
  void changed() { changed_ = true; }
  // Copies the picture to the window.
  void show() const;

  // Whether the traced truth shows what the last picture shows. If not, Look::kTruth is drawn as
  // Look::kDefault.
  bool showsTruth() const;
  // True if nothing is left to draw until something changes.
  bool whole() const { return whole_ && !streaming_; }
  // True while the picture is being refined; stats() then count a part of the picture only.
  bool refining() const { return !whole_; }
  double lastMs() const { return last_ms_; }    // time of the last advance()
  double wholeMs() const { return whole_ms_; }  // estimated time of the whole picture at full resolution
  const runtime::FrameStats& stats() const { return stats_; }
  // The picture as sRGB codes, first row at the top.
  std::vector<glm::u8vec4> codes() const { return runtime::readCodes(*shown_); }
  glm::ivec2 size() const { return shown_ ? shown_->size : glm::ivec2(0); }

 private:
  struct Piece {
    glm::ivec2 from{0}, to{0};
    Look look = Look::kDefault;
  };
  Status makeShown(glm::ivec2 size);
  // The two halves of the wipe, or one piece that is the whole picture.
  std::vector<Piece> halves(const Wipe& wipe) const;
  // Draws a piece with one sample for each `coarse` x `coarse` pixels.
  Status draw(const Piece& piece, int coarse);
  Status drawTruth(const Piece& piece);
  Status drawCoarse(const Wipe& wipe);
  Status drawNextPieces(const Wipe& wipe);
  void cutIntoPieces(const Wipe& wipe);

  World& world_;
  std::optional<runtime::RenderTarget> shown_, part_;
  std::optional<runtime::RenderTarget> truth_;  // the truth, scaled to the size of shown_
  runtime::View view_;
  runtime::FrameStats stats_;
  std::vector<Piece> left_;  // pieces that are still coarse; the next one to draw is the last
  Camera camera_;
  Wipe wipe_;
  uint64_t detail_ = 0;
  bool changed_ = true, whole_ = false, streaming_ = true;
  double last_ms_ = 0;
  double ns_per_pixel_ = 0;  // measured on the last pieces at full resolution; 0: not known
  double whole_ms_ = 0;
};

}  // namespace loden::walk
