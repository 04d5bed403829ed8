#include "sample_game/recorder.h"

#include <algorithm>
#include <cstdio>

#include "material/base/issues.h"
#include "runtime/scene/image_write.h"

namespace loden::walk {
namespace {

constexpr int kSheetCells = 16;

}  // namespace

Recorder::Recorder(const Options& options, int frames) : options_(options), frames_(frames) {
  if (!options.contact_sheet.empty() && frames > 0)
    sheet_.emplace(std::min(frames, kSheetCells), options.size);
}

Status Recorder::begin() {
  if (options_.capture.empty()) return {};
  std::error_code error;
  std::filesystem::create_directories(options_.capture, error);
  if (error)
    return Issue{issue_id::kCannotWrite, Severity::kError, options_.capture.string(), error.message()};
  return {};
}

bool Recorder::onSheet(int frame) const {
  return sheet_ && onContactSheet(frame, frames_, std::min(frames_, kSheetCells));
}

bool Recorder::wantsPixels(int frame) const {
  return !options_.capture.empty() || onSheet(frame);
}

Status Recorder::addPixels(int frame, std::span<const glm::u8vec4> pixels) {
  if (onSheet(frame)) sheet_->add(pixels);
  if (options_.capture.empty()) return {};
  char name[32];
  std::snprintf(name, sizeof name, "frame_%04d.png", frame);
  return runtime::writePng(options_.capture / name, pixels, options_.size);
}

Status Recorder::finish() {
  if (sheet_)
    if (Status status = runtime::writePng(options_.contact_sheet, sheet_->pixels(), sheet_->size()); !status)
      return status;
  if (!options_.report.empty())
    if (Status status = writeReport(options_.report, report_, options_); !status) return status;
  if (options_.quiet) return {};
  if (!options_.capture.empty()) std::printf("frames: %s\n", options_.capture.c_str());
  if (sheet_) std::printf("contact sheet: %s\n", options_.contact_sheet.c_str());
  if (!options_.report.empty()) std::printf("report: %s\n", options_.report.c_str());
  return {};
}

}  // namespace loden::walk
