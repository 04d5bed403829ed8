// A tile's polygons from a Wavefront OBJ file: v, vt, vn, f (polygons, negative indices), and Kd, Ks, Ns of
// the materials beside it. z is up.
#include <array>
#include <limits>
#include <map>
#include <sstream>

#include "importer/base/file_read.h"
#include "importer/tile/mesh_material.h"
#include "importer/tile/polygon_mesh.h"
#include "material/base/issues.h"
#include "material/system/confined_path.h"

namespace loden::importer {
namespace {

namespace fs = std::filesystem;

class ObjReader {
 public:
  explicit ObjReader(const fs::path& path) : path_(path) {}
  Result<PolygonMesh> read(const std::string& text);

 private:
  Status readLine(const std::string& keyword, std::istringstream& line);
  Result<std::vector<double>> numbers(std::istringstream& line, size_t least, size_t most,
                                      const std::string& where) const;
  Status readFace(std::istringstream& line);
  Result<uint32_t> vertex(const std::string& corner);
  Status readMaterials(const std::string& file);
  Status readMaterialLine(const std::string& keyword, std::istringstream& line, const std::string& where,
                          glm::vec3& specular, LocalBrdf& brdf);
  std::string here() const { return path_.string() + ": line " + std::to_string(line_); }
  Issue refuse(int id, const std::string& why) const { return {id, Severity::kError, here(), why}; }

  const fs::path path_;
  int line_ = 0;
  std::vector<glm::dvec3> positions_, normals_;
  std::vector<int> position_lines_;
  std::vector<glm::dvec2> uvs_;
  std::map<std::string, LocalBrdf> materials_;
  LocalBrdf brdf_;
  int material_ = 0;  // number of the usemtl in force: vertices are split between materials
  std::map<std::array<long, 4>, uint32_t> vertices_;
  PolygonMesh mesh_;
  bool without_uvs_ = false;
};

Result<PolygonMesh> ObjReader::read(const std::string& text) {
  std::istringstream file(text);
  for (std::string text_line; std::getline(file, text_line);) {
    ++line_;
    std::istringstream line(text_line);
    std::string keyword;
    line >> keyword;
    if (const Status status = readLine(keyword, line); !status) return status.issue();
  }
  if (without_uvs_) mesh_.uvs.clear();
  return std::move(mesh_);
}

// The numbers at the start of the rest of the line: `most` of them, those from `least` on 0 where the line
// ends before them.
Result<std::vector<double>> ObjReader::numbers(std::istringstream& line, size_t least, size_t most,
                                               const std::string& where) const {
  const auto issue = [&](const std::string& text) {
    return Issue{issue_id::kTileGeometry, Severity::kError, where, text};
  };
  std::vector<double> values;
  // As text first: streams refuse "nan", which must be reported as such, with its vertex.
  for (std::string token; values.size() < most && line >> token;) {
    char* end = nullptr;
    values.push_back(std::strtod(token.c_str(), &end));
    if (end == token.c_str() || *end != '\0') return issue("'" + token + "' is not a number");
  }
  if (values.size() < least)
    return issue("has " + std::to_string(values.size()) + " numbers and needs " + std::to_string(least));
  values.resize(most, 0.0);
  return values;
}

Status ObjReader::readLine(const std::string& keyword, std::istringstream& line) {
  if (keyword == "v" || keyword == "vn") {
    const auto xyz = numbers(line, 3, 3, here());
    if (!xyz) return xyz.issue();
    (keyword == "v" ? positions_ : normals_).push_back({(*xyz)[0], (*xyz)[1], (*xyz)[2]});
    if (keyword == "v") position_lines_.push_back(line_);
  } else if (keyword == "vt") {
    const auto uv = numbers(line, 1, 2, here());
    if (!uv) return uv.issue();
    uvs_.push_back({(*uv)[0], (*uv)[1]});
  } else if (keyword == "f") {
    return readFace(line);
  } else if (keyword == "mtllib") {
    std::string file;
    line >> file;
    return readMaterials(file);
  } else if (keyword == "usemtl") {
    std::string name;
    line >> name;
    const auto found = materials_.find(name);
    brdf_ = found == materials_.end() ? LocalBrdf{} : found->second;
    ++material_;
  }
  return {};
}

Result<uint32_t> ObjReader::vertex(const std::string& corner) {
  std::array<long, 4> key{0, 0, 0, material_};
  const char* at = corner.c_str();
  const size_t counts[3] = {positions_.size(), uvs_.size(), normals_.size()};
  for (size_t k = 0; k < 3; ++k) {
    char* end = nullptr;
    key[k] = std::strtol(at, &end, 10);
    const bool counted_back = key[k] < 0;  // -1: the last so far
    if (counted_back) key[k] += long(counts[k]) + 1;
    const bool none = key[k] == 0 && !counted_back && k > 0;
    if (!none && (key[k] < 1 || key[k] > long(counts[k])))
      return refuse(issue_id::kTileGeometry, "'" + corner + "' names a vertex that does not exist");
    if (*end != '/' && *end != '\0')
      return refuse(issue_id::kTileGeometry, "'" + corner + "' is no vertex of a face");
    if (*end == '\0') break;
    at = end + 1;
  }
  const auto [entry, added] = vertices_.try_emplace(key, static_cast<uint32_t>(mesh_.positions.size()));
  if (added) {
    mesh_.positions.push_back(positions_[size_t(key[0] - 1)]);
    mesh_.lines.push_back(position_lines_[size_t(key[0] - 1)]);
    mesh_.uvs.push_back(key[1] ? uvs_[size_t(key[1] - 1)] : glm::dvec2(0));
    mesh_.normals.push_back(key[2] ? normals_[size_t(key[2] - 1)] : glm::dvec3(0));
    mesh_.brdfs.push_back(brdf_);
    without_uvs_ = without_uvs_ || key[1] == 0;
  }
  return entry->second;
}

Status ObjReader::readFace(std::istringstream& line) {
  int corners = 0;
  for (std::string corner; line >> corner; ++corners) {
    const auto index = vertex(corner);
    if (!index) return index.issue();
    mesh_.corners.push_back(*index);
  }
  if (corners < 3) return refuse(issue_id::kTileGeometry, "a face has fewer than three corners");
  mesh_.face_sizes.push_back(corners);
  return {};
}

Status ObjReader::readMaterials(const std::string& file) {
  const auto path = confinedPath(path_.parent_path(), file, path_.string() + ": mtllib");
  if (!path) return path.issue();
  const auto text = readFile(*path);
  if (!text) return text.issue();
  std::istringstream lines(*text);
  std::string name;
  LocalBrdf* brdf = nullptr;
  glm::vec3 specular(0);
  int number = 0;
  for (std::string text_line; std::getline(lines, text_line);) {
    std::string where = path->string() + ": line " + std::to_string(++number);
    std::istringstream line(text_line);
    std::string keyword;
    line >> keyword;
    if (keyword == "newmtl") {
      name.clear();
      line >> name;
      brdf = &materials_[name];
      specular = glm::vec3(0);
    }
    if (!brdf) continue;
    where += ", material '" + name + "'";
    if (const Status status = readMaterialLine(keyword, line, where, specular, *brdf); !status) return status;
  }
  return {};
}

Status ObjReader::readMaterialLine(const std::string& keyword, std::istringstream& line,
                                   const std::string& where, glm::vec3& specular, LocalBrdf& brdf) {
  const auto checked = [&](double value, double most) -> Status {
    if (value >= 0 && value <= most) return {};
    std::ostringstream text;
    text << keyword << " is " << value << " and must be "
         << (most == 1 ? "0 to 1" : "a finite number from 0 on") << "; correct the material";
    return Issue{issue_id::kTileMaterial, Severity::kError, where, text.str()};
  };
  if (keyword == "Kd" || keyword == "Ks") {
    const auto rgb = numbers(line, 3, 3, where);
    if (!rgb) return rgb.issue();
    for (const double value : *rgb)
      if (Status status = checked(value, 1); !status) return status;
    (keyword == "Kd" ? brdf.diffuse : specular) = glm::vec3((*rgb)[0], (*rgb)[1], (*rgb)[2]);
  } else if (keyword == "Ns") {
    const auto exponent = numbers(line, 1, 1, where);
    if (!exponent) return exponent.issue();
    if (Status status = checked((*exponent)[0], std::numeric_limits<float>::max()); !status) return status;
    brdf.exponent = static_cast<float>((*exponent)[0]);
  } else if (keyword.starts_with("map_")) {
    mesh_.warnings.push_back({issue_id::kTileMaterial, Severity::kWarning, where,
                              keyword + " is not baked; textures are taken from glTF files"});
  }
  brdf.specular = luminance(specular) * lobePeak(brdf.exponent);
  return {};
}

}  // namespace

Result<PolygonMesh> readObjMesh(const fs::path& path) {
  const auto text = readFile(path);
  if (!text) return text.issue();
  return ObjReader(path).read(*text);
}

}  // namespace loden::importer
