// What a build of Loden::material makes of assets, as text to compare with that of other builds: a line for
// each asset with the hash of its decoded texels, of its atlas, and of what the evaluator gives; and all
// values that it gives.
//   digest VALUES ASSET...    VALUES: a file for the values, as doubles in file order
#ifndef XXH_INLINE_ALL
#define XXH_INLINE_ALL
#endif
#include <xxhash.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "material/asset/asset.h"
#include "material/eval/evaluate.h"
#include "material/model/directions.h"

namespace {

using namespace loden;
using Bytes = std::vector<std::byte>;

Bytes bytesOf(const char* path) {
  Bytes bytes;
  std::FILE* file = std::fopen(path, "rb");
  if (!file) return bytes;
  for (int c = 0; (c = std::fgetc(file)) != EOF;) bytes.push_back(static_cast<std::byte>(c));
  std::fclose(file);
  return bytes;
}

class Hash {
 public:
  void add(const void* from, size_t size) {
    const auto* begin = static_cast<const std::byte*>(from);
    bytes_.insert(bytes_.end(), begin, begin + size);
  }
  void add(const Texture& texture) { add(texture.data.data(), texture.data.size()); }
  unsigned long long value() const { return XXH3_64bits(bytes_.data(), bytes_.size()); }

 private:
  Bytes bytes_;
};

Hash texelsOf(const Material& material) {
  Hash hash;
  for (const Band& band : material.bands) hash.add(band.weights), hash.add(band.table);
  hash.add(material.geometry.texels);
  if (material.stored_vdim) hash.add(material.stored_vdim->reference), hash.add(material.stored_vdim->packed);
  if (material.surface)
    for (const SurfaceMapRow& row : kSurfaceMapRows) hash.add((*material.surface).*row.texture);
  return hash;
}

// Near the normal, at all heights, and a degree above the horizon.
std::vector<glm::dvec3> directions() {
  std::vector<glm::dvec3> list;
  for (const double theta : {0.0, 0.4, 0.9, 1.3, 1.55})
    for (const double phi : {0.1, 1.7, 4.0}) list.push_back(directionFromSpherical({theta, phi}));
  return list;
}

template <class T>
void evaluateAll(const Evaluator& evaluator, Lookup lookup, Hash& hash, std::vector<double>& values) {
  const std::vector<glm::dvec3> all = directions();
  for (const double lambda : {0.0, 0.75, 1.5, 3.25})
    for (const glm::dvec2 x : {glm::dvec2(0.13, 0.77), glm::dvec2(0.501, 0.249), glm::dvec2(-3.91, 17.05)})
      for (const glm::dvec3& wo : all) {
        const Hit<T> hit = evaluator.findHit(glm::vec<2, T>(x), T(lambda), glm::vec<3, T>(wo), lookup);
        for (const glm::dvec3& wi : all) {
          const glm::vec<3, T> value = evaluator.evaluate(hit, glm::vec<3, T>(wi), glm::vec<3, T>(wo));
          hash.add(&value, sizeof value);
          for (int c = 0; c < 3; ++c) values.push_back(double(value[c]));
        }
      }
}

// Bumps, and overhangs where `overhang`, of rational functions alone: no library of mathematics decides them.
GeometryImage bumps(bool overhang) {
  constexpr int kSide = 32;
  std::vector<glm::dvec3> positions;
  const auto bump = [](double t) {  // over one period, 0 at its ends
    const double u = t - std::floor(t);
    return 16 * u * u * (1 - u) * (1 - u);
  };
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      const glm::dvec2 p = (glm::dvec2(i, j) + 0.5) / double(kSide);
      const double height = bump(2 * p.x) * bump(p.y + 0.25);
      const glm::dvec2 lean =
          overhang ? glm::dvec2(0.12 * height * (1 - height), 0.03 * height) : glm::dvec2(0);
      positions.emplace_back(p + lean, 0.15 * height - 0.15);
    }
  return encodeGeometryImage(kSide, positions, std::vector<uint16_t>(positions.size(), 1), !overhang);
}

// All of a material.
void print(const std::string& name, const Material& material, std::vector<double>& values) {
  std::printf("%s texels %016llx\n", name.c_str(), texelsOf(material).value());
  Evaluator evaluator(material);
  evaluator.prepareQuality();
  Hash atlas;
  atlas.add(evaluator.atlas().depth), atlas.add(evaluator.atlas().volume);
  std::printf("%s atlas %016llx\n", name.c_str(), atlas.value());
  for (const Lookup lookup : {Lookup::kNone, Lookup::kFast, Lookup::kDefault, Lookup::kQuality}) {
    Hash single, twice;
    evaluateAll<float>(evaluator, lookup, single, values);
    evaluateAll<double>(evaluator, lookup, twice, values);
    std::printf("%s lookup %d float %016llx\n", name.c_str(), int(lookup), single.value());
    std::printf("%s lookup %d double %016llx\n", name.c_str(), int(lookup), twice.value());
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return 1;
  std::vector<double> values;
  for (int i = 2; i < argc; ++i) {
    const std::string path = argv[i], name = path.substr(path.rfind('/') + 1);
    const Result<Material> material = parseAsset(bytesOf(argv[i]), name);
    if (!material) {
      std::fprintf(stderr, "%s: %s\n", argv[i], material.issue().text.c_str());
      return 3;
    }
    print(name, *material, values);
    if (material->mode != Mode::kFused || material->surface) continue;
    Material relief = *material;
    for (const bool overhang : {false, true}) {
      relief.geometry = bumps(overhang);
      relief.aspect = relief.geometry.aspect = 1;
      print(name + (overhang ? " with overhangs" : " with bumps"), relief, values);
    }
  }
  std::FILE* file = std::fopen(argv[1], "wb");
  if (!file) return 2;
  std::fwrite(values.data(), sizeof values[0], values.size(), file);
  return std::fclose(file) == 0 ? 0 : 2;
}
