// V(P, wi) by the lookup towards the light, for the near term: the share of the light that reaches the point
// P that the eye's lookup has found. C++ compiles this text too (material/eval/vdim_lookup.cpp). Fetches are
// those of the lookup.

#if defined(LODEN_VISIBILITY_FAST) || defined(LODEN_VISIBILITY_DEFAULT)
#define LODEN_VISIBILITY
#ifdef LODEN_VISIBILITY_FAST
#define LODEN_LIGHT_EFFORT LODEN_EFFORT_FAST
#else
#define LODEN_LIGHT_EFFORT LODEN_EFFORT_DEFAULT
#endif

// P may lie this much below what the light meets first, in tile lengths: the patches are bilinear, and P's
// own may be met beside P. On bent rays the residuals are larger.
const float LODEN_BIAS = 4e-3, LODEN_BENT_BIAS = 6e-3;
// What is met this near to p is p's own surface; texels of the geometry image.
const float LODEN_SAME_SURFACE = 3.0;

#ifdef LODEN_HEIGHT_FIELD
// Over a flat reference surface: the share of a pixel's footprint from which the height field leaves the ray
// free, from how closely the ray from P passes it.
float loden_height_field_visibility(LodenPoint m, LodenHit hit, vec3 wi, vec2 exit_, vec3 leaving,
                                    LodenEffort effort) {
  LodenViewRay ray = loden_view_ray(m, exit_, leaving);
  float per_length = max(sqrt(dot(ray.slope, ray.slope)), 1e-6);
  float own = LODEN_SAME_SURFACE / loden_material.geometry_side;
  float lowest = hit.position.z + max(LODEN_BIAS, own / per_length);
  if (lowest >= 0.0) return 1.0;
  // A step along the surface towards the light takes the ray down by that much; the surface itself, which is
  // not sampled within `own`, shall not shade it.
  float facing = clamp(dot(hit.near.normal, wi) / max(hit.near.normal.z * wi.z, 1e-3), 0.0, 1.0);
  float footprint = exp2(hit.lambda) / loden_material.side;
  float half_ = max(min(0.5 * footprint, 0.9 * own) * facing / per_length, 1e-6);
  float rise = loden_height_field_rise(ray, lowest, half_, effort);
  return clamp(0.5 - 0.5 * rise / half_, 0.0, 1.0);
}
#endif

// V(P, wi): on a height field over a flat reference surface the mean over the pixel's footprint, elsewhere 0
// where the lookup along wi meets the tile before P, else 1. wi in the frame where the ray meets the tile.
float loden_looked_up_visibility(LodenHit hit, vec3 wi, LodenEffort effort) {
  effort = loden_effort_over(effort, hit.lambda);
  // What lies beyond is looked up at it, and has to turn with the surface as what is looked up.
  wi = loden_clamp_theta(wi, vec4(0.0, LODEN_VDIM_COS, LODEN_VDIM_SIN, 0.0));
  LodenPoint m;
  m.curvature = mat2(0.0);
  m.x_from_tangent = hit.x_from_tangent;
  vec2 slope = loden_bounded_slope(wi);
  float height = hit.position.z, rise = -height, bias = LODEN_BIAS;
  vec3 leaving = wi;
#ifdef LODEN_FOLLOW_SURFACE
  m.curvature = hit.curvature;
  vec2 turn = hit.curvature * slope;
  float bend = dot(slope, turn);
  // How far the ray rises until it leaves through the reference surface.
  rise = -2.0 * hit.position.z / (1.0 + sqrt(max(1.0 - 2.0 * bend * hit.position.z, 0.0)));
  vec2 tilt = turn * rise;
  leaving = vec3(wi.xy - tilt * wi.z, wi.z + dot(tilt, wi.xy));
  leaving /= sqrt(dot(leaving, leaving));
  if (leaving.z <= 0.0) return 1.0;  // along a convex surface, past it
  // P as a height of that ray.
  vec2 out_ = loden_bounded_slope(leaving);
  float out_bend = dot(out_, hit.curvature * out_);
  height = 2.0 * hit.position.z / (1.0 + sqrt(max(1.0 + 2.0 * out_bend * hit.position.z, 0.0)));
  if (hit.curvature != mat2(0.0)) bias = LODEN_BENT_BIAS;
#endif
  vec2 exit_ = hit.position.xy + hit.x_from_tangent * slope * rise;
#ifdef LODEN_HEIGHT_FIELD
  if (bias == LODEN_BIAS) return loden_height_field_visibility(m, hit, wi, exit_, leaving, effort);
#endif
  LodenVdimHit first = loden_atlas_lookup(m, exit_, leaving, effort);
  float own = LODEN_SAME_SURFACE / loden_material.geometry_side;
  vec2 beside = first.p - hit.p;
  beside -= floor(beside + 0.5);
  bool reaches = first.missed || first.height <= height + bias || dot(beside, beside) < own * own;
  return reaches ? 1.0 : 0.0;
}
#endif
