#include "sample_game/recorder.h"

#include <algorithm>
#include <cstdio>

#include "material/base/issues.h"
#include "runtime/scene/image_write.h"
#include "sample_game/film.h"

namespace loden::walk {
namespace {

constexpr int kSheetCells = 16;

}  // namespace

Recorder::Recorder(const Options& options, int frames) : options_(options), frames_(frames) {
  if (!options.contact_sheet.empty() && frames > 0)
    sheet_.emplace(std::min(frames, kSheetCells), options.size);
}

Status Recorder::begin() {
  for (const std::filesystem::path& folder : {options_.capture, options_.film}) {
    if (folder.empty()) continue;
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) return Issue{issue_id::kCannotWrite, Severity::kError, folder.string(), error.message()};
  }
  return {};
}

bool Recorder::onSheet(int frame) const {
  return sheet_ && onContactSheet(frame, frames_, std::min(frames_, kSheetCells));
}

bool Recorder::wantsPixels(int frame) const {
  return !options_.capture.empty() || !options_.film.empty() || onSheet(frame);
}

Status Recorder::addPixels(int frame, std::span<const glm::u8vec4> pixels) {
  if (onSheet(frame)) sheet_->add(pixels);
  for (const std::filesystem::path& folder : {options_.capture, options_.film})
    if (!folder.empty())
      if (Status status = writeFrame(folder, frame, pixels); !status) return status;
  return {};
}

Status Recorder::writeFrame(const std::filesystem::path& folder, int frame,
                            std::span<const glm::u8vec4> pixels) const {
  char name[32];
  std::snprintf(name, sizeof name, "frame_%04d.png", frame);
  return runtime::writePng(folder / name, pixels, options_.size);
}

Status Recorder::finishFilm() const {
  const std::filesystem::path film = options_.film / "film.mp4";
  const auto made = encodeFilm(options_.film, film, kFramesPerSecond);
  if (!made) return made.issue();
  if (!options_.quiet)
    std::printf("film: %s%s\n", (*made ? film : options_.film).c_str(),
                *made ? "" : " (frames; ffmpeg, which is not installed, would make a film of them)");
  return {};
}

Status Recorder::finish() {
  if (sheet_)
    if (Status status = runtime::writePng(options_.contact_sheet, sheet_->pixels(), sheet_->size()); !status)
      return status;
  if (!options_.report.empty())
    if (Status status = writeReport(options_.report, report_, options_); !status) return status;
  if (!options_.film.empty())
    if (Status status = finishFilm(); !status) return status;
  if (options_.quiet) return {};
  if (!options_.capture.empty()) std::printf("frames: %s\n", options_.capture.c_str());
  if (sheet_) std::printf("contact sheet: %s\n", options_.contact_sheet.c_str());
  if (!options_.report.empty()) std::printf("report: %s\n", options_.report.c_str());
  return {};
}

}  // namespace loden::walk
