// Records a walk: captured frames, a contact sheet, a report.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "material/base/result.h"
#include "sample_game/contact_sheet.h"
#include "sample_game/options.h"
#include "sample_game/report.h"

namespace loden::walk {

// Of films, and of animations when there is no window.
inline constexpr int kFramesPerSecond = 30;

class Recorder {
 public:
  // `frames`: how many frames there will be; 0 if that is not known.
  Recorder(const Options& options, int frames);

  // Makes the folders that files will be written to.
  Status begin();
  bool wantsPixels(int frame) const;
  // Records one frame; its pixels are sRGB codes, first row at the top.
  Status addPixels(int frame, std::span<const glm::u8vec4> pixels);
  void addFrame(FrameRecord record) { report_.frames.push_back(std::move(record)); }
  Report& report() { return report_; }
  // Writes the contact sheet and the report, and prints the names of all files that were written.
  Status finish();

 private:
  Status writeFrame(const std::filesystem::path& folder, int frame,
                    std::span<const glm::u8vec4> pixels) const;
  Status finishFilm() const;
  bool onSheet(int frame) const;

  const Options& options_;
  int frames_;
  std::optional<ContactSheet> sheet_;
  Report report_;
};

}  // namespace loden::walk
