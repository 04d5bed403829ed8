#include "importer/btf/measured/bonn_folder.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <fstream>
#include <map>
#include <mutex>

#include "importer/base/parallel.h"
#include "importer/base/progress.h"
#include "material/base/issues.h"
#include "material/model/color.h"
#include "material/system/atomic_file.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;
constexpr double kDegree = kPi / 180;

Issue measuredIssue(const fs::path& where, const std::string& text) {
  return {issue_id::kMeasured, Severity::kError, where.string(), text};
}

std::string lowered(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool isImage(const fs::path& path) {
  const std::string extension = lowered(path.extension().string());
  for (const char* known : {".jpg", ".jpeg", ".png", ".hdr", ".pic", ".exr"})
    if (extension == known) return true;
  return false;
}

// The number behind `key`, degrees; NaN if there is none. Keys stand behind a space, '_' or at the front.
double angleAfter(const std::string& name, const char* key) {
  for (size_t at = name.find(key); at != std::string::npos; at = name.find(key, at + 1)) {
    if (at > 0 && name[at - 1] != ' ' && name[at - 1] != '_') continue;
    char* end = nullptr;
    const char* begin = name.c_str() + at + 2;
    if (!std::isdigit(static_cast<unsigned char>(*begin))) continue;
    const double value = std::strtod(begin, &end);
    return value;
  }
  return std::nan("");
}

// Directions as keys: a tenth of a millidegree is the same angle.
using DirectionKey = std::pair<long, long>;
DirectionKey keyOf(Spherical s) {
  const long full = 3600000, phi = std::lround(s.phi / kDegree * 10000) % full;
  return {std::lround(s.theta / kDegree * 10000), (phi + full) % full};
}

// Known sets are recognised, so that tables by rings can be made; anything else is a list, ring by ring.
DirectionSet setOf(const std::map<DirectionKey, Spherical>& found) {
  for (const DirectionSet& known : {bonn81Directions(), ubo151Directions()}) {
    if (static_cast<size_t>(known.size()) != found.size()) continue;
    const bool same = std::all_of(known.samples.begin(), known.samples.end(), [&](const glm::dvec3& w) {
      return found.contains(keyOf(sphericalFromDirection(w)));
    });
    if (same) return known;
  }
  DirectionSet set;
  for (const auto& [key, s] : found) set.samples.push_back(directionFromSpherical(s));
  return set;
}

class BonnFolder : public MeasuredSource {
 public:
  BonnFolder(fs::path folder, DirectionSet lights, DirectionSet views, std::vector<fs::path> files,
             glm::ivec2 size)
      : name_(folder.string()),
        lights_(std::move(lights)),
        views_(std::move(views)),
        files_(std::move(files)),
        size_(size) {}
  const std::string& name() const override { return name_; }
  glm::ivec2 size() const override { return size_; }
  const DirectionSet& lights() const override { return lights_; }
  const DirectionSet& views() const override { return views_; }
  CosineFlag cosineFlag() const override { return CosineFlag::kUnknown; }
  std::string format() const override { return "Bonn image folder"; }

  Result<std::vector<glm::vec3>> view(int view) const override {
    std::vector<glm::vec3> values;
    values.reserve(size_t(size_.x) * size_.y * lights_.size());
    for (int light = 0; light < lights_.size(); ++light) {
      const fs::path& path = files_[size_t(view) * lights_.size() + light];
      const auto picture = readImage(path);
      if (!picture) return picture.issue();
      if (glm::ivec2(picture->width, picture->height) != size_)
        return measuredIssue(path, "has another size than the first image");
      for (int j = 0; j < size_.y; ++j)
        for (int i = 0; i < size_.x; ++i) values.emplace_back(picture->at(i, size_.y - 1 - j));
    }
    return values;
  }

  static Result<Picture> readImage(const fs::path& path) {
    const std::string extension = lowered(path.extension().string());
    return extension == ".hdr" || extension == ".pic" ? readRadiance(path) : readPicture(path);
  }

 private:
  std::string name_;
  DirectionSet lights_, views_;
  std::vector<fs::path> files_;  // [view][light]
  glm::ivec2 size_;
};

std::string angleText(double radians) {
  const double degrees = radians / kDegree;
  char text[16];
  const bool whole = std::abs(degrees - std::round(degrees)) < 1e-6;
  std::snprintf(text, sizeof text, whole ? "%03.0f" : "%05.1f", degrees);
  return text;
}

}  // namespace

std::optional<BonnAngles> parseBonnName(const std::string& file_name) {
  const std::string name = lowered(file_name);
  const double tl = angleAfter(name, "tl"), pl = angleAfter(name, "pl"), tv = angleAfter(name, "tv"),
               pv = angleAfter(name, "pv");
  if (!(tl >= 0 && tl <= 90 && tv >= 0 && tv <= 90) || std::isnan(pl) || std::isnan(pv)) return std::nullopt;
  // The pole has one azimuth.
  return BonnAngles{{tl * kDegree, tl == 0 ? 0 : pl * kDegree}, {tv * kDegree, tv == 0 ? 0 : pv * kDegree}};
}

bool looksLikeBonnFolder(const fs::path& folder) {
  std::error_code error;
  for (auto it = fs::recursive_directory_iterator(folder, error);
       !error && it != fs::recursive_directory_iterator(); it.increment(error))
    if (isImage(it->path())) return parseBonnName(it->path().filename().string()).has_value();
  return false;
}

Result<std::unique_ptr<MeasuredSource>> openBonnFolder(const fs::path& folder) {
  std::map<DirectionKey, Spherical> lights, views;
  std::map<std::pair<DirectionKey, DirectionKey>, fs::path> images;  // (view, light)
  std::error_code error;
  for (auto it = fs::recursive_directory_iterator(folder, error);
       !error && it != fs::recursive_directory_iterator(); it.increment(error)) {
    const auto angles = isImage(it->path()) ? parseBonnName(it->path().filename().string()) : std::nullopt;
    if (!angles) continue;
    lights.emplace(keyOf(angles->light), angles->light);
    views.emplace(keyOf(angles->view), angles->view);
    const auto [entry, is_new] =
        images.emplace(std::pair(keyOf(angles->view), keyOf(angles->light)), it->path());
    if (!is_new)
      return measuredIssue(it->path(), "has the same directions as " + entry->second.filename().string());
  }
  if (images.empty()) return measuredIssue(folder, "holds no image named by tl, pl, tv, pv");
  const DirectionSet light_set = setOf(lights), view_set = setOf(views);
  std::vector<fs::path> files;
  size_t missing = 0;
  std::string first_missing;
  for (const glm::dvec3& wo : view_set.samples)
    for (const glm::dvec3& wi : light_set.samples) {
      const Spherical v = sphericalFromDirection(wo), l = sphericalFromDirection(wi);
      const auto image = images.find({keyOf(v), keyOf(l)});
      if (image != images.end())
        files.push_back(image->second);
      else if (missing++ == 0)
        first_missing = "tl" + angleText(l.theta) + " pl" + angleText(l.phi) + " tv" + angleText(v.theta) +
                        " pv" + angleText(v.phi);
    }
  if (missing)
    return measuredIssue(folder, "lacks " + std::to_string(missing) + " images, first " + first_missing);
  const auto first = BonnFolder::readImage(files.front());
  if (!first) return first.issue();
  return std::unique_ptr<MeasuredSource>(std::make_unique<BonnFolder>(
      folder, light_set, view_set, std::move(files), glm::ivec2(first->width, first->height)));
}

namespace {

Status writeImage(const Picture& picture, const fs::path& path, BonnEncoding encoding) {
  if (encoding != BonnEncoding::kJpeg) return writePicture(picture, path, Flush::kLater);
  std::vector<unsigned char> rgb;
  for (const glm::vec4& pixel : picture.pixels)
    for (int c = 0; c < 3; ++c)
      rgb.push_back(static_cast<unsigned char>(
          std::lround(srgbFromLinear(std::clamp(double(pixel[c]), 0.0, 1.0)) * 255)));
  const auto bytes = encodeRgb8(rgb, picture.width, picture.height, PictureCodec::kJpeg);
  if (!bytes) return bytes.issue();
  return writeFileAtomically(path, std::as_bytes(std::span(*bytes)), Flush::kLater);
}

Status writeView(const BtfSource& source, const fs::path& folder, BonnEncoding encoding, int view) {
  const auto values = source.view(view);
  if (!values) return values.issue();
  const glm::ivec2 size = source.size();
  const size_t texels = size_t(size.x) * size.y;
  const Spherical v = sphericalFromDirection(source.views().samples[view]);
  const std::string view_text = "tv" + angleText(v.theta), view_phi = "pv" + angleText(v.phi);
  const fs::path view_folder = folder / (view_text + "_" + view_phi);
  std::error_code error;
  fs::create_directories(view_folder, error);
  const char* extension = encoding == BonnEncoding::kJpeg  ? ".jpg"
                          : encoding == BonnEncoding::kHdr ? ".hdr"
                                                           : ".exr";
  for (int light = 0; light < source.lights().size(); ++light) {
    const Spherical l = sphericalFromDirection(source.lights().samples[light]);
    char index[16];
    std::snprintf(index, sizeof index, "%05d", view * source.lights().size() + light);
    Picture picture{size.x, size.y, std::vector<glm::vec4>(texels)};
    for (int j = 0; j < size.y; ++j)
      for (int i = 0; i < size.x; ++i)
        picture.at(i, size.y - 1 - j) = glm::vec4((*values)[light * texels + size_t(j) * size.x + i], 1);
    const std::string name = std::string(index) + " tl" + angleText(l.theta) + " pl" + angleText(l.phi) +
                             " " + view_text + " " + view_phi + extension;
    if (const Status status = writeImage(picture, view_folder / name, encoding); !status) return status;
  }
  return {};
}

}  // namespace

Status writeBonnFolder(const BtfSource& source, const fs::path& folder, BonnEncoding encoding, int threads,
                       bool quiet) {
  std::optional<Issue> issue;
  std::mutex mutex;
  Progress progress("write " + folder.filename().string(), source.views().size(), quiet);
  parallelFor(source.views().size(), threads, [&](size_t view) {
    if (const Status status = writeView(source, folder, encoding, static_cast<int>(view)); !status) {
      const std::lock_guard lock(mutex);
      issue = status.issue();
    }
    progress.advance();
  });
  if (issue) return *issue;
  return flushFileSystem(folder);
}

}  // namespace loden::importer
