// The report that `loden_walk --report` writes.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "material/base/result.h"
#include "runtime/frame/frame.h"
#include "runtime/gl/device.h"
#include "runtime/gl/material/material_system.h"
#include "runtime/shader/shader_library.h"
#include "sample_game/options.h"

namespace loden::walk {

struct FrameRecord {
  double t = 0;        // seconds on the camera path
  double ms = 0;       // from prepare to the end of GPU work
  double wait_ms = 0;  // spent waiting for the loading thread, not part of `ms`
  runtime::FrameStats stats;
  runtime::MaterialStats materials;
};

struct Report {
  runtime::Capabilities gl;
  double start_ms = 0;  // from the start of the process to the first frame
  std::vector<FrameRecord> frames;
  std::optional<Camera> camera;  // where a walk in a window ended
  runtime::ShaderStats shaders;
};

// Writes the report as JSON of the schema loden/walk/1. Issues: kCannotWrite.
Status writeReport(const std::filesystem::path& path, const Report& report, const Options& options);

}  // namespace loden::walk
