// The reference evaluator: the one equation on the CPU, in float or double. shaders/loden_material.glsl
// mirrors it name for name; tests hold both to 1e-3 of white.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "material/eval/near_term.h"
#include "material/model/environment.h"
#include "material/model/material.h"

namespace loden {

// One shading point, found once per pixel and shared by all lights.
template <class T>
struct Hit {
  glm::vec<2, T> x{0};     // reference domain, tile periods
  glm::vec<2, T> p{0};     // parameter domain; equal to x without meso-geometry
  T lambda = 0;            // level of detail
  T depth = 0;             // height of the hit over the tangent plane at x, tile lengths, <= 0
  int fetches = 0;         // of the lookup, and of near maps
  bool missed = false;     // the ray goes by a convex surface without meeting the tile
  glm::vec<2, T> tilt{0};  // of the surface's normal at the hit against that at x, on a curved surface
  // For the lookup towards the light:
  glm::vec<3, T> position{0};     // the hit P, tile periods; z in tile lengths below the reference surface
  LocalSurface<T> surface;        // around x
  bool relief = false;            // position is a point of the tile's geometry
  Lookup lookup = Lookup::kNone;  // that found it
};

// Whether the lookup fades out where its parallax is below half a texel of the level shown, as the shaders do
// by default (LodenPoint::skip_parallax); kFull is what fits and comparisons measure.
enum class Parallax : uint32_t { kFull, kFaded };

// Share of the parallax to apply, 0..1, at 1 wherever p is not x without it. Mirrors loden_parallax_fade.
template <class T>
T parallaxFade(const Material& material, T lambda, const glm::vec<3, T>& wo);

// The tangent frame at x (columns: tangent, bitangent, normal) turned to where the ray meets the tile.
// Mirrors loden_hit_frame.
template <class T>
glm::mat<3, 3, T> hitFrame(const Hit<T>& hit, const glm::mat<3, 3, T>& frame);

// Keeps what is derived from a material: VDIM atlas (of Material::atlas), nearest-direction images. The
// material must outlive it and stay where it is.
class Evaluator {
 public:
  // `for_each` runs what there is to build; the result does not depend on it.
  explicit Evaluator(const Material& material, const ForEach& for_each = inOrder);
  explicit Evaluator(Material&&, const ForEach& = inOrder) = delete;

  const Material& material() const { return *material_; }
  const VdimAtlas& atlas() const { return atlas_; }

  // Builds what Lookup::kQuality reads; a material with geometry needs it for that.
  void prepareQuality();

  // x in tile periods, any finite value; lambda clamped to the finest level that the material has, 0 or that
  // of finer near maps, which is also what a NaN shows; wo unit, wo.z > 0. p is x, without a fetch, where
  // nothing that shows at lambda is read at p.
  template <class T>
  Hit<T> findHit(glm::vec<2, T> x, T lambda, const glm::vec<3, T>& wo, Lookup lookup, Parallax parallax,
                 const LocalSurface<T>& surface) const;
  // On a flat surface without stretch.
  template <class T>
  Hit<T> findHit(glm::vec<2, T> x, T lambda, const glm::vec<3, T>& wo, Lookup lookup = Lookup::kDefault,
                 Parallax parallax = Parallax::kFull) const {
    return findHit(x, lambda, wo, lookup, parallax, LocalSurface<T>::flat(material_->geometry.aspect));
  }

  // Linear RGB, white Lambert lit from above = 1: pi f_r cos(theta_i), also where the asset's values leave
  // the cosine out; radiance = irradiance * value_scale * this. Not negative: where a fit undershoots black,
  // 0; so is light or sight from below, or along a vector that is zero or not finite.
  template <class T>
  glm::vec<3, T> evaluate(const Hit<T>& hit, const glm::vec<3, T>& wi, const glm::vec<3, T>& wo) const;

  // Builds what evaluateEnvironment reads.
  void prepareEnvironment();
  // evaluate() integrated with light from all around, over pi: radiance = pi * value_scale * this. Not
  // negative. The light is that of hitFrame(hit, frame). After prepareEnvironment(), but for mode surface.
  template <class T>
  glm::vec<3, T> evaluateEnvironment(const Hit<T>& hit, const HemisphereLight& light,
                                     const glm::vec<3, T>& wo) const;

 private:
  VdimMaps vdimMaps() const;
  template <class T>
  glm::vec<3, T> evaluateNearTerm(const Hit<T>& hit, const glm::vec<3, T>& wi,
                                  const glm::vec<3, T>& wo) const;

  const Material* material_;
  VdimAtlas atlas_;
  std::optional<GeometryTracer> tracer_;
  EnvironmentMean environment_mean_;
  std::vector<Texture> environment_tables_;
  std::vector<uint8_t> nearest_light_, nearest_view_;
};

// E_b(wi, wo) as evaluate() reads it, for one quad and without its scale; both directions at most theta_max
// from the normal.
glm::vec4 tableValue(const Material& material, const Band& band, int quad, const glm::vec3& wi,
                     const glm::vec3& wo);

}  // namespace loden
