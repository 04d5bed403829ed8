// The lookups. Those of the atlas and of the published map are the text of shaders/loden_vdim.glsl.

#include <cmath>
#include <cstring>
#include <tuple>

#include "material/eval/glsl.h"
#include "material/model/vdim.h"

namespace loden {
namespace {

using namespace glsl;

// The index of 0 .. n - 1 under a texel coordinate of a row that repeats; 0 if it is not finite.
int texelIndex(double texel, int n) {
  const double index = texel - double(n) * std::floor(texel / double(n));
  return index >= 0 && index < double(n) ? static_cast<int>(index) : 0;
}

// Indices of the four texels that a gather reads, in its order: (0, 1), (1, 1), (1, 0), (0, 0) from the lower
// left one. `at` is their common corner, in periods.
struct Gathered {
  size_t index[4];
  Gathered(glm::dvec2 at, int side) {
    const int x0 = texelIndex(std::floor(at.x * side - 0.5), side);
    const int y0 = texelIndex(std::floor(at.y * side - 0.5), side);
    const size_t x1 = x0 + 1 < side ? x0 + 1 : 0, low = size_t(y0) * side;
    const size_t high = y0 + 1 < side ? low + side : 0;
    index[0] = high + x0, index[1] = high + x1, index[2] = low + x1, index[3] = low + x0;
  }
};

// Samplers of what shaders/loden_interface.glsl declares, read as the GPU reads them.
struct HeightSampler {
  const Texture* texture = nullptr;
  double height(size_t texel) const {
    uint16_t code;
    std::memcpy(&code, texture->data.data() + 2 * texel, sizeof code);
    return code / 65535.0;
  }
};
vec4 textureGather(HeightSampler heights, vec2 at, int) {
  const Gathered texels(at, heights.texture->width);
  return {heights.height(texels.index[0]), heights.height(texels.index[1]), heights.height(texels.index[2]),
          heights.height(texels.index[3])};
}
vec4 textureLod(HeightSampler heights, vec2 at, double) {
  const vec4 h = textureGather(heights, at, 0);
  const glm::dvec2 f = glm::fract(glm::dvec2(at) * double(heights.texture->width) - 0.5);
  return {glm::mix(glm::mix(h.w, h.z, f.x), glm::mix(h.x, h.y, f.x), f.y), 0, 0, 1};
}

struct GeometrySampler {
  const Texture* texture = nullptr;
};
uvec4 textureGather(GeometrySampler geometry, vec2 at, int) {
  const Gathered texels(at, geometry.texture->width);
  uvec4 codes;
  for (int k = 0; k < 4; ++k)
    std::memcpy(&codes[k], geometry.texture->data.data() + 4 * texels.index[k], sizeof(uint32_t));
  return codes;
}

struct DepthSampler {
  const Texture* texture = nullptr;
};
vec4 textureGather(DepthSampler depths, vec3 at, int) {
  const int n = depths.texture->width;
  const auto* codes = reinterpret_cast<const uint8_t*>(depths.texture->data.data()) +
                      static_cast<size_t>(texelIndex(at.z, depths.texture->depth)) * n * n;
  const Gathered texels({at.x, at.y}, n);
  return vec4(codes[texels.index[0]], codes[texels.index[1]], codes[texels.index[2]],
              codes[texels.index[3]]) /
         255.0;
}

struct TexelSampler {
  const Texture* texture = nullptr;
};
ivec3 textureSize(TexelSampler sampler, int) {
  const Texture& t = *sampler.texture;
  return {t.width, t.height, t.depth};
}
vec4 texelFetch(TexelSampler sampler, ivec3 at, int) {
  const ivec3 inside = glm::clamp(at, ivec3(0), textureSize(sampler, 0) - 1);
  return vec4(fetchTexel(*sampler.texture, 0, inside.x, inside.y, inside.z));
}
vec4 textureLod(TexelSampler sampler, vec3 at, double) {
  return sampleRepeat(*sampler.texture, 0, static_cast<int>(at.z), glm::dvec2(at));
}

// What the text reads, by its names, and the count of its texture instructions.
struct LookupInputs {
  struct {
    int atlas_texels = 1, atlas_directions = 1;
    vec3 geometry_range{1.0};
    double geometry_side = 1, side = 1;
    vec2 paper_range{1.0}, paper_size{1.0};
  } loden_material;
  HeightSampler loden_height;
  GeometrySampler loden_geometry;
  DepthSampler loden_vdim_depth;
  TexelSampler loden_vdim_volume, loden_paper_reference, loden_paper_packed;
  int loden_fetches = 0;

  LookupInputs() = default;
  explicit LookupInputs(const VdimAtlas& atlas) {
    loden_material.atlas_texels = atlas.size.texels;
    loden_material.atlas_directions = atlas.size.directions;
    loden_material.geometry_range = glm::dvec3(atlas.geometry.range);
    loden_material.geometry_side = atlas.geometry.side();
    loden_height.texture = loden_geometry.texture = &atlas.geometry.texels;
    loden_vdim_depth.texture = &atlas.depth;
    loden_vdim_volume.texture = &atlas.volume;
  }
  explicit LookupInputs(const PaperVdim& vdim) {
    loden_material.paper_range = glm::dvec2(vdim.range);
    loden_material.paper_size = {vdim.zeniths, vdim.azimuths};
    loden_paper_reference.texture = &vdim.reference;
    loden_paper_packed.texture = &vdim.packed;
  }
};

// The text's variants: of height fields, and of all else.
#include "material/eval/glsl_begin.h"
#define LODEN_FOLLOW_SURFACE
#define LODEN_LOOKUP_PAPER
#define LODEN_VISIBILITY_DEFAULT
struct PatchProgram : LookupInputs {
  using LookupInputs::LookupInputs;
#include "shaders/loden_directions.glsl"
#include "shaders/loden_types.glsl"
#include "shaders/loden_vdim.glsl"
#include "shaders/loden_visibility.glsl"
};
#define LODEN_HEIGHT_FIELD
struct HeightProgram : LookupInputs {
  using LookupInputs::LookupInputs;
#include "shaders/loden_directions.glsl"
#include "shaders/loden_types.glsl"
#include "shaders/loden_vdim.glsl"
#include "shaders/loden_visibility.glsl"
};
#include "material/eval/glsl_end.h"

template <class Program>
auto effortOf(Lookup lookup) {
  return lookup == Lookup::kFast ? Program::LODEN_EFFORT_FAST : Program::LODEN_EFFORT_DEFAULT;
}

template <class Program>
auto materialOf(const LocalSurface<double>& surface) {
  typename Program::LodenPoint m{};
  m.curvature = surface.curvature;
  m.x_from_tangent = surface.x_from_tangent;
  return m;
}

template <class Program>
[[gnu::flatten]] VdimHit<double> atlasLookup(const VdimAtlas& atlas, Lookup lookup, glm::dvec2 x,
                                             const glm::dvec3& wo, const LocalSurface<double>& surface,
                                             double footprint) {
  Program program(atlas);
  const auto effort = program.loden_effort_over(effortOf<Program>(lookup), std::log2(footprint));
  const auto found = program.loden_atlas_lookup(materialOf<Program>(surface), vec2(x), vec3(wo), effort);
  return {.p = found.p,
          .position = {x + found.offset, found.z},
          .offset = found.offset,
          .height = found.height,
          .fetches = program.loden_fetches,
          .converged = found.converged,
          .missed = found.missed};
}

// What lookedUpVisibility is asked.
struct LightRay {
  LocalSurface<double> surface;
  glm::dvec3 position;
  glm::dvec2 p;
  glm::dvec3 normal, wi;
  double footprint;
};

template <class Program>
[[gnu::flatten]] double visibilityOf(const VdimAtlas& atlas, Lookup lookup, const LightRay& ray,
                                     int* fetches) {
  Program program(atlas);
  typename Program::LodenHit hit{};
  hit.p = ray.p;
  hit.lambda = std::log2(ray.footprint);
  hit.near.normal = ray.normal;
  hit.position = ray.position;
  hit.curvature = ray.surface.curvature;
  hit.x_from_tangent = ray.surface.x_from_tangent;
  const double visibility = program.loden_looked_up_visibility(hit, vec3(ray.wi), effortOf<Program>(lookup));
  if (fetches) *fetches += program.loden_fetches;
  return visibility;
}

VdimHit<double> paperLookup(const PaperVdim& vdim, glm::dvec2 x, const glm::dvec3& wo) {
  PatchProgram program(vdim);
  const glm::dvec2 p = program.loden_paper_vdim_lookup(vec2(x), vec3(wo));
  return {.p = p, .fetches = program.loden_fetches};
}

VdimHit<double> tracedLookup(const GeometryTracer& tracer, glm::dvec2 x, const glm::dvec3& wo,
                             const LocalSurface<double>& surface) {
  PatchProgram program;
  auto m = materialOf<PatchProgram>(surface);
  m.curvature = glm::dmat2(0);
  const auto ray = program.loden_view_ray(m, vec2(x), vec3(wo));
  // Where texture coordinates are stretched the ray is that of an unstretched tile.
  const vec2 slope = ray.slope / periodsPerLength(tracer.aspect());
  const auto found = tracer.traceView(ray.x, program.loden_view_along(slope));
  if (!found) return {.p = x, .position = {x, 0}};
  const double z = found->position.z;
  const glm::dvec2 offset = ray.slope * z;
  return {.p = found->p + glm::floor(x),
          .position = {x + offset, z},
          .offset = offset,
          .height = z,
          .converged = true};
}

VdimHit<double> lookUp(const VdimMaps& maps, Lookup lookup, glm::dvec2 x, const glm::dvec3& wo,
                       const LocalSurface<double>& surface, double footprint) {
  if (maps.serve(lookup)) switch (lookup) {
      case Lookup::kNone:
        break;
      case Lookup::kPaper:
        return paperLookup(*maps.paper, x, wo);
      case Lookup::kFast:
      case Lookup::kDefault:
        return maps.atlas->geometry.identity_parameterization
                   ? atlasLookup<HeightProgram>(*maps.atlas, lookup, x, wo, surface, footprint)
                   : atlasLookup<PatchProgram>(*maps.atlas, lookup, x, wo, surface, footprint);
      case Lookup::kQuality:
        return tracedLookup(*maps.tracer, x, wo, surface);
    }
  return {.p = x, .position = {x, 0}};
}

template <class T>
LocalSurface<double> inDouble(const LocalSurface<T>& surface) {
  return {glm::dmat2(surface.curvature), glm::dmat2(surface.x_from_tangent)};
}

}  // namespace

std::string_view lookupName(Lookup lookup) {
  switch (lookup) {
    case Lookup::kNone:
      return "none";
    case Lookup::kPaper:
      return "paper";
    case Lookup::kFast:
      return "fast";
    case Lookup::kDefault:
      return "default";
    case Lookup::kQuality:
      return "quality";
  }
  return "unknown";
}

std::optional<Lookup> lookupNamed(std::string_view name) {
  for (const Lookup lookup : kLookups)
    if (lookupName(lookup) == name) return lookup;
  return std::nullopt;
}

bool effortsAreOne(int geometry_side, double footprint) {
  PatchProgram program;
  program.loden_material.geometry_side = geometry_side;
  const auto spent = [&](Lookup lookup) {
    const auto effort = program.loden_effort_over(effortOf<PatchProgram>(lookup), std::log2(footprint));
    return std::tuple(effort.layers, effort.visits, effort.step_, effort.samples, effort.inside);
  };
  return spent(Lookup::kFast) == spent(Lookup::kDefault);
}

bool VdimMaps::serve(Lookup lookup) const {
  switch (lookup) {
    case Lookup::kNone:
      return false;
    case Lookup::kPaper:
      return paper != nullptr;
    case Lookup::kFast:
    case Lookup::kDefault:
      return atlas != nullptr;
    case Lookup::kQuality:
      return tracer != nullptr;
  }
  return false;
}

float VdimMaps::aspect() const {
  if (atlas) return atlas->geometry.aspect;
  return tracer ? tracer->aspect() : 1.0f;
}

template <class T>
VdimHit<T> vdimLookup(const VdimMaps& maps, Lookup lookup, glm::vec<2, T> x, const glm::vec<3, T>& wo) {
  return vdimLookup(maps, lookup, x, wo, LocalSurface<T>::flat(maps.aspect()));
}

template <class T>
VdimHit<T> vdimLookup(const VdimMaps& maps, Lookup lookup, glm::vec<2, T> x, const glm::vec<3, T>& wo,
                      const LocalSurface<T>& surface, T footprint) {
  const VdimHit<double> hit = lookUp(maps, lookup, x, wo, inDouble(surface), footprint);
  return {.p = hit.p,
          .position = hit.position,
          .offset = hit.offset,
          .height = T(hit.height),
          .fetches = hit.fetches,
          .converged = hit.converged,
          .missed = hit.missed};
}

template <class T>
T lookedUpVisibility(const VdimAtlas& atlas, Lookup lookup, const LocalSurface<T>& surface,
                     const glm::vec<3, T>& position, glm::vec<2, T> p, const glm::vec<3, T>& normal,
                     const glm::vec<3, T>& wi, T footprint, int* fetches) {
  const LightRay ray{inDouble(surface),  glm::dvec3(position), glm::dvec2(p),
                     glm::dvec3(normal), glm::dvec3(wi),       double(footprint)};
  return T(atlas.geometry.identity_parameterization
               ? visibilityOf<HeightProgram>(atlas, lookup, ray, fetches)
               : visibilityOf<PatchProgram>(atlas, lookup, ray, fetches));
}

template <class T>
glm::vec<2, T> vdimSquareFromView(const glm::vec<3, T>& wo) {
  return PatchProgram().loden_vdim_square_from_view(vec3(wo));
}

template glm::vec<2, float> vdimSquareFromView(const glm::vec<3, float>&);
template glm::vec<2, double> vdimSquareFromView(const glm::vec<3, double>&);
template float lookedUpVisibility(const VdimAtlas&, Lookup, const LocalSurface<float>&,
                                  const glm::vec<3, float>&, glm::vec<2, float>, const glm::vec<3, float>&,
                                  const glm::vec<3, float>&, float, int*);
template double lookedUpVisibility(const VdimAtlas&, Lookup, const LocalSurface<double>&,
                                   const glm::vec<3, double>&, glm::vec<2, double>,
                                   const glm::vec<3, double>&, const glm::vec<3, double>&, double, int*);
template VdimHit<float> vdimLookup(const VdimMaps&, Lookup, glm::vec<2, float>, const glm::vec<3, float>&,
                                   const LocalSurface<float>&, float);
template VdimHit<double> vdimLookup(const VdimMaps&, Lookup, glm::vec<2, double>, const glm::vec<3, double>&,
                                    const LocalSurface<double>&, double);
template VdimHit<float> vdimLookup(const VdimMaps&, Lookup, glm::vec<2, float>, const glm::vec<3, float>&);
template VdimHit<double> vdimLookup(const VdimMaps&, Lookup, glm::vec<2, double>, const glm::vec<3, double>&);

}  // namespace loden
