// Loden's shader library: evaluates one material. No dependency on any renderer; include this file, or paste
// what it includes in its place. GLSL 4.40; Vulkan needs LODEN_DESCRIPTOR_SET defined. What the uniform block
// holds is said in loden_shared.h; runtime/stream/material_data.cpp fills it. Defines of a variant
// (runtime/stream/shader_variants.h lists those in use):
//   LODEN_NEAR, LODEN_BANDS n (1..LODEN_MAX_BANDS), or both    what the material is
//   LODEN_BOUND_BANDS n                                        bands whose textures are bound, of a near term
//                                                              that is drawn without them
//   LODEN_VISIBILITY_FAST, _DEFAULT or none of them            cast shadows of the near term, by that lookup
//   LODEN_VISIBILITY_MAP n (1..LODEN_MAX_SHADOW_QUADS)         or by a shadow map of n quads
//   LODEN_INDIRECT                                             the near term has light that comes by way of
//   the
//                                                              tile
//   LODEN_TABLES_NEAREST                                       tables are read at the nearest sampled pair
//   LODEN_LOOKUP_DEFAULT, _FAST, _PAPER or none of them        how p is found; none: p = x
//   LODEN_HEIGHT_FIELD                                         in a height field, whose points have P.xy = p
//   LODEN_FOLLOW_SURFACE                                       view rays and light rays bend with the surface
//   LODEN_COUNT_FETCHES                                        counts texture instructions in loden_fetches
//   LODEN_NO_BRANCH, LODEN_ALWAYS_LOOKUP                       evaluates closed windows, finds p where no
//                                                              band reads it, to measure the gain of leaving
//                                                              them out
//
// Use, in a fragment shader with x the texture coordinate in tile periods and a tangent frame:
//   LodenPoint m = loden_point_default();
//   loden_follow_surface(m, ...);             where the surface is curved; needs LODEN_FOLLOW_SURFACE
//   LodenHit h = loden_find_hit(m, x, dFdx(x), dFdy(x), wo_ts);           once per pixel
//   radiance += irradiance * loden_material.value_scale * loden_evaluate(h, wi_ts, wo_ts);   per light
// Light from all around: loden_environment.glsl, which this file includes.

#include "loden_shared.h"
#include "loden_interface.glsl"
#include "loden_directions.glsl"
#include "loden_vdim.glsl"
#include "loden_visibility.glsl"
#include "loden_near.glsl"
#include "loden_bands.glsl"

// Footprint of a pixel on the reference plane -> lambda. Reads the minor axis, or half the major one if that
// is longer: blur along a stretched footprint is bounded, and so is aliasing.
float loden_lambda_from_footprint(vec2 dx, vec2 dy) {
  float side = loden_material.side;
  float xx = dot(dx, dx), yy = dot(dy, dy);
  float major = sqrt(max(xx, yy)), minor = sqrt(min(xx, yy));
  return log2(max(max(minor, 0.5 * major) * side, 1e-6));
}

// How many evaluations along a stretched footprint cover it without gaps at that lambda, 1 or 2, and the step
// between them: tap k of n belongs at x + (k - (n - 1) / 2) step. One alone leaves regular tiles to beat with
// the pixels in grazing views.
int loden_footprint_taps(vec2 dx, vec2 dy, out vec2 step_) {
  float xx = dot(dx, dx), yy = dot(dy, dy);
  step_ = 0.5 * (xx > yy ? dx : dy);
  return max(xx, yy) > 2.25 * min(xx, yy) ? 2 : 1;
}

#ifdef LODEN_FOLLOW_SURFACE
// Tells m how the reference surface bends and how x lies on it, from screen-space derivatives of x, and of
// position and unit normal, both in the tangent frame. FBTF 3.1 names a geometric proxy of equal curvature
// for this; here the view ray bends instead, in the lookup.
void loden_follow_surface(inout LodenPoint m, vec2 dx, vec2 dy, vec3 dp_dx, vec3 dp_dy, vec3 dn_dx,
                          vec3 dn_dy) {
  float det = dp_dx.x * dp_dy.y - dp_dx.y * dp_dy.x, stretch = dx.x * dy.y - dx.y * dy.x;
  float area = sqrt(dot(dp_dx, dp_dx) * dot(dp_dy, dp_dy));
  float periods = sqrt(abs(stretch / det));  // per unit of position
  if (!(abs(det) > 1e-3 * area) || !(periods > 0.0) || stretch * det <= 0.0)
    return;  // edge on, or not mapped to an area
  mat2 screen_from_tangent = mat2(dp_dy.y, -dp_dx.y, -dp_dy.x, dp_dx.x) * (1.0 / (det * periods));
  mat2 k = mat2(dn_dx.xy, dn_dy.xy) * screen_from_tangent;
  vec3 bounded =
      clamp(vec3(k[0].x, 0.5 * (k[0].y + k[1].x), k[1].y), -LODEN_MAX_CURVATURE, LODEN_MAX_CURVATURE);
  m.curvature = mat2(bounded.xy, bounded.yz);
  m.x_from_tangent = mat2(dx, dy) * screen_from_tangent;
  m.tile_length = 1.0 / periods;
}
#endif

// LBTF 3.4, step 2; distance in units at which one texel covers one pixel.
float loden_lambda_from_distance(float distance_) {
  return log2(max(distance_, 1e-6));
}

// Share of the parallax to apply: 1 down to half a texel of the level that is shown, then fading to 0, so
// that the lookup can be skipped where nothing of it is seen.
float loden_parallax_fade(float lambda, vec3 wo) {
#ifndef LODEN_HEIGHT_FIELD
  return 1.0;  // only where P.xy == p is p = x without parallax
#else
  float slope = length(loden_material.periods_per_length * wo.xy) / max(wo.z, LODEN_VDIM_COS);
#ifdef LODEN_VISIBILITY
  // Shadows show from above, too; the light is taken to come at 45 degrees at least.
  slope = max(slope, 1.0);
#endif
  float texels = loden_material.geometry_range.z * slope * loden_material.side * exp2(-lambda);
  return clamp(4.0 * texels - 1.0, 0.0, 1.0);
#endif
}

// Share of what is shown at this lambda that is read at p; 0: nobody asks for it.
float loden_parameter_share(float lambda) {
  float share = 0.0;
#ifdef LODEN_NEAR
  share = loden_near_weight(lambda);
#endif
#ifdef LODEN_BANDS
  for (int b = 0; b < LODEN_BANDS; ++b)
    if ((loden_material.bands[b].bits & LODEN_BAND_FLAT) != 0)
      share = max(share, loden_window_weight(loden_material.bands[b].window, lambda));
#endif
  return share;
}

// A hit that was found in some other way, at p and without a point of the tile's geometry: nothing shadows
// it.
LodenHit loden_hit_at_parameter(vec2 x, vec2 p, float lambda) {
  LodenHit hit;
  hit.x = x;
  hit.p = p;
  hit.lambda = lambda;
  hit.depth = 0.0;
  hit.tilt = vec2(0.0);
  hit.missed = false;
  hit.position = vec3(x, 0.0);
  hit.relief = false;
  hit.curvature = mat2(0.0);
  hit.x_from_tangent = mat2(1.0);
#ifdef LODEN_NEAR
  hit.near_weight = loden_near_weight(lambda);
  if (hit.near_weight > 0.0) hit.near = loden_near_point(p, lambda);
#else
  hit.near_weight = 0.0;
#endif
  return hit;
}

// All levels from here on are alike: no asset has as many mips. Renderers that turn a level into an integer
// take no infinite one.
const float LODEN_MOST_LAMBDA = 100.0;

LodenHit loden_find_hit_at(LodenPoint m, vec2 x, float lambda, vec3 wo) {
  LodenHit hit;
  hit.x = x;
  hit.p = x;
  hit.depth = 0.0;
  hit.tilt = vec2(0.0);
  hit.missed = false;
  hit.lambda = min(max(m.lambda_min, lambda), LODEN_MOST_LAMBDA);  // in this order: lambda_min of a NaN
  hit.position = vec3(x, 0.0);
  hit.relief = false;
  hit.curvature = m.curvature;
  hit.x_from_tangent = m.x_from_tangent;
  if ((loden_material.bits & LODEN_CLAMP_LAMBDA) != 0)
    hit.lambda = min(hit.lambda, loden_material.lambda_max);
#if defined(LODEN_LOOKUP_PAPER)
  hit.p = loden_paper_vdim_lookup(x, wo);
#elif defined(LODEN_LOOKUP_DEFAULT) || defined(LODEN_LOOKUP_FAST)
  float fade = m.skip_parallax ? loden_parallax_fade(hit.lambda, wo) : 1.0;
  fade *= float(loden_material.geometry_resident);  // 0 until geometry and VDIM are resident
  float share = loden_parameter_share(hit.lambda);
#ifdef LODEN_ALWAYS_LOOKUP
  if (fade > 0.0) {
#else
  if (fade > 0.0 && share > 0.0) {
#endif
    LodenVdimHit found = loden_vdim_lookup(m, x, hit.lambda, wo);
    hit.p = mix(x, found.p, fade);
    hit.depth = found.height * fade * min(2.0 * share, 1.0);
#ifdef LODEN_FOLLOW_SURFACE
    hit.tilt = m.curvature * (inverse(m.x_from_tangent) * found.offset) * (fade * share);
#endif
    hit.missed = found.missed && fade * share >= 0.5;
    hit.position = vec3(x + found.offset * fade, found.z * fade);
    hit.relief = !found.missed;
  }
#endif
#ifdef LODEN_NEAR
  hit.near_weight = loden_near_weight(hit.lambda);
  if (hit.near_weight > 0.0) hit.near = loden_near_point(hit.p, hit.lambda);
#else
  hit.near_weight = 0.0;
#endif
  return hit;
}

LodenHit loden_find_hit(LodenPoint m, vec2 x, vec2 dx, vec2 dy, vec3 wo_ts) {
  float lambda =
      m.distance_ > 0.0 ? loden_lambda_from_distance(m.distance_) : loden_lambda_from_footprint(dx, dy);
  return loden_find_hit_at(m, x, lambda + m.lambda_bias, wo_ts);
}

// (Y, Cb, Cr) of the fitted mean (LBTF eqs. 5, 6).
vec3 loden_evaluate_mean(vec3 wi, vec3 wo) {
  vec3 sum = wi + wo;
  float half_cosine = max(sum.z / sqrt(max(dot(sum, sum), 1e-12)), 0.0);
  vec4 k = loden_material.mean;
  float y = k.x + k.y * max(wi.z, 0.0) + k.z * pow(half_cosine, k.w);
  float chroma_scale = (loden_material.bits & LODEN_MEAN_RATIO) != 0 ? y : 1.0;
  return vec3(y, loden_material.mean_chroma * chroma_scale);
}

vec3 loden_rgb_from_ycc(vec3 ycc) {
  return vec3(ycc.x + 1.402 * ycc.z, ycc.x - 0.344136286201022 * ycc.y - 0.714136286201022 * ycc.z,
              ycc.x + 1.772 * ycc.y);
}

// A direction of the frame at x in the frame where the ray meets the tile, whose normal is that of x plus
// tilt. A vector that has none, as it is zero or not finite, counts as one from below.
vec3 loden_tilted(vec2 tilt, vec3 w) {
  vec3 turned = vec3(w.xy - tilt * w.z, w.z + dot(tilt, w.xy));
  float square = dot(turned, turned);
  return square > 1e-30 && square < 1e30 ? turned / sqrt(square) : vec3(0.0, 0.0, -1.0);
}

// The tangent frame at x (columns: tangent, bitangent, normal) turned to where the ray meets the tile.
mat3 loden_hit_frame(LodenHit hit, mat3 frame) {
  return mat3(normalize(frame[0] - hit.tilt.x * frame[2]), normalize(frame[1] - hit.tilt.y * frame[2]),
              normalize(hit.tilt.x * frame[0] + hit.tilt.y * frame[1] + frame[2]));
}

// Linear RGB in white units (white Lambert lit from above = 1): pi f_r cos(theta_i), also where the asset's
// values leave the cosine out. Not negative: where a fit undershoots black, 0.
vec3 loden_evaluate(LodenHit hit, vec3 wi_ts, vec3 wo_ts) {
  wi_ts = loden_tilted(hit.tilt, wi_ts);
  wo_ts = loden_tilted(hit.tilt, wo_ts);
  if (wi_ts.z <= 0.0 || wo_ts.z <= 0.0) return vec3(0.0);
  vec3 shown = vec3(0.0);
#ifdef LODEN_NEAR
  if (hit.near_weight > 0.0) shown = hit.near_weight * loden_evaluate_near_term(hit, wi_ts, wo_ts);
  if (hit.near_weight >= 1.0) return shown;
#endif
#ifdef LODEN_BANDS
  vec3 wi = loden_clamp_theta(wi_ts, loden_material.theta_max);
  vec3 wo = loden_clamp_theta(wo_ts, loden_material.theta_max);
  bool with_cosine = (loden_material.bits & LODEN_COSINE_INCLUDED) != 0;
  float cosine = with_cosine ? min(wi_ts.z / loden_material.theta_max.y, 1.0) : wi_ts.z;
  vec3 mean = loden_evaluate_mean(wi, wo);
  vec3 bands = loden_evaluate_bands(hit, loden_table_position(wi, wo), mean);
  shown += (1.0 - hit.near_weight) * (max(loden_rgb_from_ycc(mean + bands), 0.0) * cosine);
#endif
  return shown;
}

#include "loden_environment.glsl"
