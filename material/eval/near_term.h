// The near term of the equation, V(P, wi) A(p; wi, wo) + C(p, wi): what is known of the surface. Mirrors
// shaders/loden_near.glsl name for name.
#pragma once

#include <glm/glm.hpp>

#include "material/model/environment.h"
#include "material/model/material.h"

namespace loden {

// The local reflectance at one point, filtered; the same for all lights.
template <class T>
struct NearPoint {
  glm::vec<3, T> mapped{0, 0, 1};  // mean normal, not longer than 1
  glm::vec<3, T> normal{0, 0, 1};  // the same of unit length
  glm::vec<3, T> diffuse{0};       // albedo
  glm::vec<3, T> f0{0};            // GGX: reflectance at normal incidence
  T strength = 0;                  // Phong: value at the lobe's peak
  T width = 1;                     // Phong: exponent; GGX: alpha
};

// The maps read at p at a level of detail; two fetches of the shaders.
template <class T>
NearPoint<T> nearPoint(const SurfaceMaps& maps, glm::vec<2, T> p, T lambda);

// A(p; wi, wo) = pi f_r cos, linear RGB, of directions above the reference plane.
template <class T>
glm::vec<3, T> evaluateNear(Lobe lobe, const NearPoint<T>& point, const glm::vec<3, T>& wi,
                            const glm::vec<3, T>& wo);

// A, V and C integrated with light from all around, over pi: the diffuse part exactly as the ambient map has
// it, the light along the mirror direction, blurred as the lobe's width asks, times what the lobe reflects,
// and C exactly.
template <class T>
glm::vec<3, T> evaluateNearEnvironment(const SurfaceMaps& maps, const NearPoint<T>& point, glm::vec<2, T> p,
                                       T lambda, const HemisphereLight& light, const glm::vec<3, T>& wo);

// Share of diffuse light that the surface returns, per colour channel: of its diffuse part and, as if seen at
// the mean cosine 2 / 3, of its lobe.
template <class T>
glm::vec<3, T> nearAlbedo(Lobe lobe, const NearPoint<T>& point);

// C(p, wi) by the map of indirect light; 0 without it. wi above the reference plane. Two fetches of the
// shaders, shared by all lights.
template <class T>
glm::vec<3, T> indirectLight(const SurfaceMaps& maps, const NearPoint<T>& point, glm::vec<2, T> p, T lambda,
                             const glm::vec<3, T>& wi);

// Share of light from direction w that a GGX lobe reflects, for f0 (Lazarov 2013; Karis 2014: the fit to the
// split sum's table). cosine of w and the normal.
template <class T>
glm::vec<3, T> lobeAlbedo(T alpha, const glm::vec<3, T>& f0, T cosine);

// Light from all around that a Phong lobe of strength 1 returns, white sky = 1: the integral over l of
// (N.H)^e N.L / pi, within .075 of the numerical one. Cosine of the view and the normal.
template <class T>
T phongAlbedo(T exponent, T cosine);

// V(p, wi) by the shadow map: two fetches of the shaders for each of its layers, of which the one of the
// weights is shared by all lights.
template <class T>
T mappedVisibility(const SurfaceMaps& maps, glm::vec<2, T> p, T lambda, const glm::vec<3, T>& wi);

}  // namespace loden
