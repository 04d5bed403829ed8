#include "sample_game/picture.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace loden::walk {

using namespace runtime;

namespace {

using Clock = std::chrono::steady_clock;

constexpr double kSmoothMs = 40;  // frames up to this are drawn whole, whatever moves
constexpr double kBusyMs = 100;   // what may be drawn before the window answers again
constexpr int kCoarsest = 6;      // pixels of the window per pixel drawn, along each side

double millisecondsSince(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

bool same(const Camera& a, const Camera& b) {
  return a.position == b.position && a.target == b.target && a.up == b.up && a.fov_degrees == b.fov_degrees;
}

FrameSettings settingsFor(const FrameSettings& settings, Look look) {
  FrameSettings result = settings;
  if (look == Look::kFallback) result.base_materials_only = true;
  if (look == Look::kSurface) result.visibility = Visibility::kNone;
  if (look == Look::kParallax) result.parallax_occlusion = true;
  return result;
}

}  // namespace

DepthRange depthRange(const Bounds& all, const Camera& camera) {
  DepthRange range;
  const glm::dvec3 nearest = glm::clamp(camera.position, glm::dvec3(all.min), glm::dvec3(all.max));
  if (const double distance = glm::distance(camera.position, nearest); distance > 0)
    range.near_plane = std::min(range.near_plane, distance / 2);
  const double reach = glm::distance(camera.position, glm::dvec3(all.centre())) + double(all.radius());
  if (reach <= range.far_plane) return range;
  return {range.near_plane * reach / range.far_plane, reach};
}

Status Picture::makeShown(glm::ivec2 size) {
  if (shown_ && shown_->size == size) return {};
  auto made = makeRenderTarget(size, ColorFormat::kSrgb8, "shown");
  if (!made) return made.issue();
  shown_ = std::move(*made);
  changed_ = true;
  return {};
}

std::vector<Picture::Piece> Picture::halves(const Wipe& wipe) const {
  const glm::ivec2 size = shown_->size;
  if (!wipe.on) return {{{0, 0}, size, Look::kDefault}};
  const int border = std::clamp(static_cast<int>(wipe.border * float(size.x)), 1, std::max(size.x - 1, 1));
  return {{{0, 0}, {border, size.y}, wipe.left}, {{border, 0}, size, wipe.right}};
}

bool Picture::showsTruth() const {
  return world_.truth && shown_ && isOf(*world_.truth, camera_, shown_->size);
}

Status Picture::drawTruth(const Piece& piece) {
  if (!truth_ || truth_->size != shown_->size) {
    const auto whole = makePicture(world_.truth->codes, world_.truth->size, "traced truth");
    if (!whole) return whole.issue();
    auto made = makeRenderTarget(shown_->size, ColorFormat::kSrgb8, "traced truth as shown");
    if (!made) return made.issue();
    truth_ = std::move(*made);
    copyPicture(*whole, truth_->framebuffer.name(), {0, 0}, truth_->size);
  }
  copyRectangle(*truth_, shown_->framebuffer.name(), piece.from, piece.to);
  return {};
}

Status Picture::draw(const Piece& piece, int coarse) {
  if (piece.look == Look::kTruth && showsTruth()) return drawTruth(piece);
  const glm::ivec2 extent = piece.to - piece.from, size = glm::max((extent + coarse - 1) / coarse, 1);
  if (!part_ || part_->size != size) {
    auto made = makeRenderTarget(size, ColorFormat::kSrgb8, "part of the picture");
    if (!made) return made.issue();
    part_ = std::move(*made);
  }
  // As many samples at any resolution: software renderers compile programs anew for each number of them.
  world_.renderer->prepare(partOf(view_, piece.from, piece.to, size),
                           settingsFor(world_.settings, piece.look));
  if (Status status = world_.renderer->draw({part_->framebuffer.name(), size}); !status) return status;
  copyPicture(*part_, shown_->framebuffer.name(), piece.from, piece.to);
  world_.renderer->finish();
  return {};
}

Status Picture::drawCoarse(const Wipe& wipe) {
  const double pixels = double(shown_->size.x) * shown_->size.y;
  const double expected = ns_per_pixel_ * pixels * 1e-6;
  // What is not known yet is taken for slow.
  int coarse = ns_per_pixel_ == 0 ? kCoarsest : 1;
  if (expected > kSmoothMs)
    coarse = std::clamp(static_cast<int>(std::ceil(std::sqrt(expected / kBusyMs))), 2, kCoarsest);
  const auto start = Clock::now();
  for (const Piece& half : halves(wipe))
    if (Status status = draw(half, coarse); !status) return status;
  if (coarse == 1) {
    ns_per_pixel_ = millisecondsSince(start) * 1e6 / pixels;
    left_.clear();
    whole_ = true;
    return {};
  }
  whole_ = false;
  cutIntoPieces(wipe);
  return {};
}

// From the middle outwards: last is drawn first.
void Picture::cutIntoPieces(const Wipe& wipe) {
  constexpr int kSide = 96;
  left_.clear();
  for (const Piece& half : halves(wipe)) {
    const glm::ivec2 extent = half.to - half.from, count = (extent + kSide - 1) / kSide;
    for (int j = 0; j < count.y; ++j)
      for (int i = 0; i < count.x; ++i) {
        const glm::ivec2 at(i, j);
        left_.push_back({half.from + extent * at / count, half.from + extent * (at + 1) / count, half.look});
      }
  }
  const glm::ivec2 middle = shown_->size / 2;
  const auto distance = [&](const Piece& piece) {
    const glm::ivec2 arm = (piece.from + piece.to) / 2 - middle;
    return arm.x * arm.x + arm.y * arm.y;
  };
  std::stable_sort(left_.begin(), left_.end(),
                   [&](const Piece& a, const Piece& b) { return distance(a) > distance(b); });
}

Status Picture::drawNextPieces(const Wipe&) {
  const auto start = Clock::now();
  double pixels = 0;
  while (!left_.empty() && millisecondsSince(start) < kBusyMs) {
    const Piece piece = left_.back();
    left_.pop_back();
    if (Status status = draw(piece, 1); !status) return status;
    const glm::ivec2 extent = piece.to - piece.from;
    pixels += double(extent.x) * extent.y;
  }
  const double now = millisecondsSince(start) * 1e6 / std::max(pixels, 1.0);
  ns_per_pixel_ = ns_per_pixel_ == 0 ? now : 0.7 * ns_per_pixel_ + 0.3 * now;
  whole_ = left_.empty();
  return {};
}

Status Picture::advance(const Camera& camera, glm::ivec2 size, const Wipe& wipe, float seconds) {
  const auto start = Clock::now();
  if (Status status = makeShown(size); !status) return status;
  changed_ = changed_ || !same(camera, camera_) || !(wipe == wipe_);
  camera_ = camera;
  wipe_ = wipe;
  view_ = makeView(camera, size, depthRange(world_.renderer->bounds(), camera));
  world_.renderer->prepare(view_, world_.settings);
  stats_ = world_.renderer->stats();
  world_.materials->update(seconds);
  const uint64_t detail = world_.renderer->detailRevision();
  streaming_ = detail != detail_ || world_.materials->stats().parts_in_flight > 0;
  if (changed_ || detail != detail_) {
    if (Status status = drawCoarse(wipe); !status) return status;
  } else if (!whole_) {
    if (Status status = drawNextPieces(wipe); !status) return status;
  }
  detail_ = detail;
  changed_ = false;
  last_ms_ = millisecondsSince(start);
  whole_ms_ = ns_per_pixel_ * double(size.x) * size.y * 1e-6;
  return {};
}

void Picture::show() const {
  copyPicture(*shown_, 0, {0, 0}, shown_->size);
}

}  // namespace loden::walk
