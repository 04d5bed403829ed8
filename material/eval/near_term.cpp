// Mirrors shaders/loden_near.glsl name for name; keep the order of operations.

#include "material/eval/near_term.h"

#include <algorithm>
#include <cmath>

namespace loden {
namespace {

template <class T>
using V2 = glm::vec<2, T>;
template <class T>
using V3 = glm::vec<3, T>;

constexpr float kDielectric = 0.04f;     // f0 of what is no metal (glTF 2.0, appendix B)
constexpr float kLeastAlpha = 0.002f;    // of GGX
constexpr float kLeastView = 0.02f;      // N.V that lobes are evaluated for
constexpr float kMeanCosine = 2.0f / 3;  // at which the lobe's albedo is about its mean

template <class T>
T schlick(T cosine) {
  const T x = std::max(T(1) - cosine, T(0));
  return x * x * x * x * x;
}

// Mirrors loden_ggx_coupling: share of the diffuse light that the lobe leaves over, (1 - E(wi)) (1 - E(wo)) /
// (1 - mean E) (Kelemen and Szirmay-Kalos 2001), for the largest channel of f0.
template <class T>
T coupling(const NearPoint<T>& point, T cos_light, T cos_view) {
  const V3<T> f0(std::max({point.f0.x, point.f0.y, point.f0.z}));
  const T light = T(1) - lobeAlbedo(point.width, f0, cos_light).x;
  const T view = T(1) - lobeAlbedo(point.width, f0, cos_view).x;
  const T mean = T(1) - lobeAlbedo(point.width, f0, T(kMeanCosine)).x;
  return light * view / std::max(mean, T(1e-3));
}

// What the map of indirect light holds at a point: e(p, wi) = color max(0, wi.z dot(c, (1, wi.z, wi.x,
// wi.y))).
template <class T>
struct Indirect {
  V3<T> color;
  glm::vec<4, T> c;
};

template <class T>
Indirect<T> indirectAt(const SurfaceMaps& maps, V2<T> p, T lambda) {
  const T lod = lambda - T(maps.ambient_first);
  const V3<T> root(sampleRepeatLod(maps.indirect, lod, 0, p));
  return {root * root, sampleRepeatLod(maps.indirect, lod, 1, p)};
}

}  // namespace

const char* visibilityName(Visibility visibility) {
  constexpr const char* kNames[] = {"none", "fast", "default", "map"};
  return visibility <= Visibility::kMap ? kNames[static_cast<size_t>(visibility)] : "unknown";
}

float finestLevel(const Material& material) {
  if (material.lambda_min > 0 || !material.surface) return material.lambda_min;
  return std::min(material.surface->lambda_first, 0.0f);
}

template <class T>
T phongAlbedo(T exponent, T cosine) {
  return T(8) / (exponent + T(8)) * (T(2.2) + exponent * cosine * cosine) / (T(2.2) + exponent);
}

template <class T>
T nearWeight(const Material& material, T lambda) {
  if (!material.surface) return T(0);
  if (material.bands.empty()) return T(1);
  const SurfaceMaps& maps = *material.surface;
  const T share = (T(maps.fade_end) - lambda) / (T(maps.fade_end) - T(maps.fade_begin));
  return std::clamp(share, T(0), T(1));
}

template <class T>
V3<T> lobeAlbedo(T alpha, const V3<T>& f0, T cosine) {
  const T roughness = std::sqrt(alpha);
  const T x = T(1) - roughness, y = T(0.0425) - T(0.0275) * roughness, z = T(1.04) - T(0.572) * roughness,
          w = T(-0.04) + T(0.022) * roughness;
  const T a = std::min(x * x, std::exp2(T(-9.28) * std::max(cosine, T(0)))) * x + y;
  const T scale = z - T(1.04) * a, offset = T(1.04) * a + w;
  return glm::clamp(f0 * scale + offset, T(0), T(1));
}

template <class T>
NearPoint<T> nearPoint(const SurfaceMaps& maps, V2<T> p, T lambda) {
  const T lod = lambda - T(maps.lambda_first);
  const glm::vec<4, T> normal = sampleRepeatLod(maps.normal, lod, 0, p);
  glm::vec<4, T> color = sampleRepeatLod(maps.color, lod, 0, p);
  color = {color.x * color.x, color.y * color.y, color.z * color.z, color.w};
  NearPoint<T> point;
  point.mapped = V3<T>(normal);
  point.normal = point.mapped / std::max(std::sqrt(glm::dot(point.mapped, point.mapped)), T(1e-4));
  const T width = std::max(normal.w, T(0));
  if (maps.lobe == Lobe::kGgx) {
    point.diffuse = V3<T>(color) * (T(1) - color.w);
    point.f0 = glm::mix(V3<T>(kDielectric), V3<T>(color), color.w);
    point.width = std::max(width * width, T(kLeastAlpha));
  } else {
    point.diffuse = V3<T>(color);
    point.strength = color.w * T(maps.specular_scale);
    point.width = std::exp2(T(12) * width);
  }
  return point;
}

template <class T>
V3<T> evaluateNear(Lobe lobe, const NearPoint<T>& point, const V3<T>& wi, const V3<T>& wo) {
  const T diffuse = std::max(glm::dot(point.mapped, wi), T(0));
  const V3<T> sum = wi + wo;
  const V3<T> half = sum / std::max(std::sqrt(glm::dot(sum, sum)), T(1e-6));
  const T nl = std::max(glm::dot(point.normal, wi), T(0));
  const T nh = std::clamp(glm::dot(point.normal, half), T(0), T(1));
  if (lobe == Lobe::kPhong) {
    const T shine = point.strength * std::pow(std::max(nh, T(1e-6)), point.width) * nl;
    return point.diffuse * diffuse + shine;
  }
  const T nv = std::max(glm::dot(point.normal, wo), T(kLeastView));
  const T a2 = point.width * point.width;
  const T d = nh * nh * (a2 - T(1)) + T(1);
  const T masking = nl * std::sqrt(nv * nv * (T(1) - a2) + a2) + nv * std::sqrt(nl * nl * (T(1) - a2) + a2);
  const T shine = a2 / (d * d) * T(0.5) / std::max(masking, T(1e-6)) * nl;
  const V3<T> fresnel = point.f0 + (T(1) - point.f0) * schlick(glm::dot(wi, half));
  return point.diffuse * (diffuse * coupling(point, nl, nv)) + fresnel * shine;
}

template <class T>
V3<T> nearAlbedo(Lobe lobe, const NearPoint<T>& point) {
  if (lobe == Lobe::kPhong) return point.diffuse + point.strength * phongAlbedo(point.width, T(kMeanCosine));
  const V3<T> f0(std::max({point.f0.x, point.f0.y, point.f0.z}));
  const T left = T(1) - lobeAlbedo(point.width, f0, T(kMeanCosine)).x;
  return point.diffuse * left + lobeAlbedo(point.width, point.f0, T(kMeanCosine));
}

template <class T>
V3<T> indirectLight(const SurfaceMaps& maps, const NearPoint<T>& point, V2<T> p, T lambda, const V3<T>& wi) {
  if (maps.indirect.width == 0) return V3<T>(0);
  const Indirect<T> at = indirectAt(maps, p, lambda);
  const T entering = wi.z * (at.c.x + at.c.y * wi.z + at.c.z * wi.x + at.c.w * wi.y);
  return nearAlbedo(maps.lobe, point) * at.color * std::max(entering, T(0));
}

template <class T>
V3<T> evaluateNearEnvironment(const SurfaceMaps& maps, const NearPoint<T>& point, V2<T> p, T lambda,
                              const HemisphereLight& light, const V3<T>& wo) {
  const T lod = lambda - T(maps.ambient_first);
  const glm::vec<4, T> first = sampleRepeatLod(maps.ambient, lod, 0, p);
  const glm::vec<4, T> second = sampleRepeatLod(maps.ambient, lod, 1, p);
  const auto l = [&](int k) { return V3<T>(light.c[k]); };
  const V3<T> none(0);
  const V3<T> irradiance = glm::max(
      l(0) * first.x + l(1) * first.y + l(2) * first.z + l(3) * first.w + l(4) * second.x + l(5) * second.y,
      none);
  const V3<T>& n = point.normal;
  const T nv = std::max(glm::dot(n, wo), T(kLeastView));
  V3<T> r = T(2) * glm::dot(n, wo) * n - wo;
  r.z = std::max(r.z, T(0));
  // A Phong lobe of exponent e about H is one of about e / 4 about r, which keeps exp(-l (l + 1) 2 / e) of
  // order l; a GGX lobe is about one of exponent 2 / alpha^2.
  const bool ggx = maps.lobe == Lobe::kGgx;
  const T exponent = ggx ? T(2) / (point.width * point.width) : point.width;
  const T order1 = std::exp(T(-4) / exponent), order2 = std::exp(T(-12) / exponent);
  const V3<T> mirrored = glm::max(l(0) + order1 * (l(1) * r.z + l(2) * r.x + l(3) * r.y) +
                                      order2 * (l(4) * (r.x * r.y) + l(5) * (r.x * r.x - r.y * r.y)),
                                  none);
  // What meets the surface of a white sky stands for what meets it along the mirror direction.
  const T open = std::clamp(first.x / std::max(T(0.5) + T(0.5) * n.z, T(0.05)), T(0), T(1));
  V3<T> indirect(0);
  if (maps.indirect.width > 0) {
    // The integrals of the basis times wi.z (1, wi.z, wi.x, wi.y), over pi.
    const Indirect<T> at = indirectAt(maps, p, lambda);
    const V3<T> entering = l(0) * (at.c.x + T(2.0 / 3) * at.c.y) +
                           l(1) * (T(2.0 / 3) * at.c.x + T(0.5) * at.c.y) +
                           T(0.25) * (l(2) * at.c.z + l(3) * at.c.w);
    indirect = nearAlbedo(maps.lobe, point) * at.color * glm::max(entering, none);
  }
  if (!ggx)
    return point.diffuse * irradiance + (point.strength * phongAlbedo(point.width, nv)) * open * mirrored +
           indirect;
  const V3<T> shine = lobeAlbedo(point.width, point.f0, nv);
  const V3<T> f0(std::max({point.f0.x, point.f0.y, point.f0.z}));
  const T left = T(1) - lobeAlbedo(point.width, f0, nv).x;
  return point.diffuse * (irradiance * left) + shine * open * mirrored + indirect;
}

template <class T>
T mappedVisibility(const SurfaceMaps& maps, V2<T> p, T lambda, const V3<T>& wi) {
  const Texture& table = maps.shadow_table;
  const T lod = lambda - T(maps.ambient_first);
  const V2<T> at = squareFromDirection(wi) * T(table.width - 1) + T(0.5);
  T shadow = 0;
  for (int quad = 0; quad < table.depth; ++quad)
    shadow += glm::dot(sampleRepeatLod(maps.shadow, lod, quad, p),
                       sampleVolume(table, V3<T>(at, T(quad) + T(0.5))));
  return std::clamp(T(1) - shadow, T(0), T(1));
}

template float nearWeight(const Material&, float);
template double nearWeight(const Material&, double);
template glm::vec<3, float> lobeAlbedo(float, const glm::vec<3, float>&, float);
template glm::vec<3, double> lobeAlbedo(double, const glm::vec<3, double>&, double);
template float phongAlbedo(float, float);
template double phongAlbedo(double, double);
template NearPoint<float> nearPoint(const SurfaceMaps&, glm::vec<2, float>, float);
template NearPoint<double> nearPoint(const SurfaceMaps&, glm::vec<2, double>, double);
template glm::vec<3, float> evaluateNear(Lobe, const NearPoint<float>&, const glm::vec<3, float>&,
                                         const glm::vec<3, float>&);
template glm::vec<3, double> evaluateNear(Lobe, const NearPoint<double>&, const glm::vec<3, double>&,
                                          const glm::vec<3, double>&);
template glm::vec<3, float> evaluateNearEnvironment(const SurfaceMaps&, const NearPoint<float>&,
                                                    glm::vec<2, float>, float, const HemisphereLight&,
                                                    const glm::vec<3, float>&);
template glm::vec<3, double> evaluateNearEnvironment(const SurfaceMaps&, const NearPoint<double>&,
                                                     glm::vec<2, double>, double, const HemisphereLight&,
                                                     const glm::vec<3, double>&);
template glm::vec<3, float> nearAlbedo(Lobe, const NearPoint<float>&);
template glm::vec<3, double> nearAlbedo(Lobe, const NearPoint<double>&);
template glm::vec<3, float> indirectLight(const SurfaceMaps&, const NearPoint<float>&, glm::vec<2, float>,
                                          float, const glm::vec<3, float>&);
template glm::vec<3, double> indirectLight(const SurfaceMaps&, const NearPoint<double>&, glm::vec<2, double>,
                                           double, const glm::vec<3, double>&);
template float mappedVisibility(const SurfaceMaps&, glm::vec<2, float>, float, const glm::vec<3, float>&);
template double mappedVisibility(const SurfaceMaps&, glm::vec<2, double>, double, const glm::vec<3, double>&);

}  // namespace loden
