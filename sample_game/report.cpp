#include "sample_game/report.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "material/system/atomic_file.h"

namespace loden::walk {
namespace {

using Json = nlohmann::ordered_json;

Json glJson(const runtime::Capabilities& gl) {
  return {{"vendor", gl.vendor},
          {"renderer", gl.renderer},
          {"version", gl.version},
          {"glsl", gl.glsl_version},
          {"software", gl.software}};
}

Json optionsJson(const Options& options) {
  Json json{{"size", {options.size.x, options.size.y}},
            {"budget_mb", options.budget_mb},
            {"upload_kb", options.upload_kb},
            {"mode", modeName(options.mode)},
            {"headless", options.headless},
            {"stream", options.stream}};
  if (options.lambda_rule == runtime::LambdaRule::kDistance) json["lambda_rule"] = "distance";
  if (options.lambda) json["lambda"] = *options.lambda;
  return json;
}

Json frameJson(const FrameRecord& frame, size_t index) {
  const auto demands = [](const char* kind, const std::vector<runtime::MaterialDemand>& all) {
    Json list = Json::array();
    for (const runtime::MaterialDemand& demand : all)
      list.push_back({{kind, demand.name}, {"lambda", demand.lambda}, {"resident_lambda", demand.resident}});
    return list;
  };
  return {{"frame", index},
          {"t", frame.t},
          {"ms", frame.ms},
          {"wait_ms", frame.wait_ms},
          {"objects", frame.stats.objects},
          {"visible_objects", frame.stats.visible_objects},
          {"visible_materials", frame.stats.demands.size()},
          {"draw_calls", frame.stats.draw_calls},
          {"depth_draw_calls", frame.stats.depth_draw_calls},
          {"program_changes", frame.stats.program_changes},
          {"triangles", frame.stats.triangles},
          {"resident_bytes", frame.materials.resident_bytes},
          {"texture_bytes", frame.materials.texture_bytes},
          {"uploaded_bytes", frame.materials.uploaded_last_frame},
          {"read_bytes", frame.materials.read_bytes},
          {"evicted_parts", frame.materials.evicted_parts},
          {"materials", demands("material", frame.stats.demands)},
          {"textures", demands("texture", frame.stats.textures)}};
}

// The value below which `share` of all lie.
double percentile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[std::min(values.size() - 1, static_cast<size_t>(share * static_cast<double>(values.size())))];
}

Json summaryJson(const Report& report) {
  std::vector<double> ms;
  for (const FrameRecord& frame : report.frames) ms.push_back(frame.ms);
  runtime::MaterialStats last;
  if (!report.frames.empty()) last = report.frames.back().materials;
  return {{"frames", report.frames.size()},
          {"start_ms", report.start_ms},
          {"ms_median", percentile(ms, 0.5)},
          {"ms_p99", percentile(ms, 0.99)},
          {"materials", last.materials},
          {"textures", last.textures},
          {"peak_bytes", last.peak_bytes},
          {"total_bytes", last.total_bytes},
          {"read_bytes", last.read_bytes},
          {"failed_parts", last.failed_parts},
          {"programs_compiled", report.shaders.compiled},
          {"programs_from_cache", report.shaders.from_cache},
          {"program_seconds", report.shaders.seconds}};
}

}  // namespace

Status writeReport(const std::filesystem::path& path, const Report& report, const Options& options) {
  Json json{{"schema", "loden/walk/1"},        {"command", options.command},     {"gl", glJson(report.gl)},
            {"options", optionsJson(options)}, {"summary", summaryJson(report)}, {"frames", Json::array()}};
  if (report.camera) {
    const auto vec = [](const glm::dvec3& v) { return Json{v.x, v.y, v.z}; };
    json["camera"] = {{"position", vec(report.camera->position)},
                      {"target", vec(report.camera->target)},
                      {"up", vec(report.camera->up)},
                      {"fov_degrees", report.camera->fov_degrees}};
  }
  for (size_t i = 0; i < report.frames.size(); ++i) json["frames"].push_back(frameJson(report.frames[i], i));
  // Names come from files and drivers, and need not be UTF-8.
  const std::string text = json.dump(1, ' ', false, Json::error_handler_t::replace) + '\n';
  return writeFileAtomically(path, std::as_bytes(std::span(text)));
}

}  // namespace loden::walk
