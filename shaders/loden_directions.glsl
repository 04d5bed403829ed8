// Directions and the maps between them and tables. Mirrors material/model/directions.h; unit vectors in the
// tangent frame of the reference plane, pointing away from the surface.

const float LODEN_PI = 3.14159265358979;
// Views beyond 85 degrees are looked up at it (material/model/vdim.h, kThetaMax).
const float LODEN_VDIM_COS = 0.0871557427476582;
const float LODEN_VDIM_SIN = 0.996194698091746;
const float LODEN_VDIM_RIM = 3.13130133147093;  // atanh(sin 85 degrees)

// atan(t) 4 / pi for t in [0, 1], to 1e-5 (after Hastings 1955).
float loden_octant(float t) {
  float t2 = t * t;
  return min(t * (1.27307 + t2 * (-0.42055 + t2 * (0.22936 + t2 * (-0.10839 + t2 * 0.02653)))), 1.0);
}

// Concentric map of directions to the square [0,1]^2 (Shirley and Chiu 1997). The radius is
// atanh(sine) / atanh(sin 85 degrees).
vec2 loden_vdim_square_from_view(vec3 wo) {
  float sine = sqrt(wo.x * wo.x + wo.y * wo.y);
  float clamped = min(sine, LODEN_VDIM_SIN);
  float radius = min(0.5 * log((1.0 + clamped) / (1.0 - clamped)) / LODEN_VDIM_RIM, 1.0);
  vec2 a = abs(wo.xy);
  float longer = max(a.x, a.y);
  float other = radius * loden_octant(min(a.x, a.y) / max(longer, 1e-6));
  vec2 map = a.x >= a.y ? vec2(radius, other) : vec2(other, radius);
  return 0.5 + 0.5 * mix(map, -map, lessThan(wo.xy, vec2(0.0)));
}

// w.xy / w.z of a direction, at most LODEN_VDIM_SIN / LODEN_VDIM_COS long.
vec2 loden_bounded_slope(vec3 w) {
  float cosine = max(w.z, LODEN_VDIM_COS);
  float sine = sqrt(w.x * w.x + w.y * w.y);
  float scale = min(1.0, LODEN_VDIM_SIN / max(sine, 1e-6));
  return w.xy * (scale / cosine);
}

// theta_max = (radians, cosine, sine, 1 / radians): the direction, at most that far from the normal.
vec3 loden_clamp_theta(vec3 w, vec4 theta_max) {
  if (w.z >= theta_max.y) return w;
  float sine = sqrt(w.x * w.x + w.y * w.y);
  return vec3(w.xy * (theta_max.z / max(sine, 1e-6)), theta_max.y);
}

// (phi / 2 pi, theta / theta_max) of a direction, 0..1: where it stands in any lat-long grid up to theta_max.
vec2 loden_grid_position(vec3 w, vec4 theta_max) {
  float theta = acos(clamp(w.z, -1.0, 1.0));
  float phi = w.x == 0.0 && w.y == 0.0 ? 0.0 : atan(w.y, w.x);
  phi = phi < 0.0 ? phi + 2.0 * LODEN_PI : phi;
  return vec2(phi / (2.0 * LODEN_PI), min(theta * theta_max.w, 1.0));
}

// Square [0,1]^2 from a direction above the plane, without trigonometry (the hemioct map of Cigolle et al.
// 2014).
vec2 loden_square_from_direction(vec3 w) {
  float scale = 0.5 / (abs(w.x) + abs(w.y) + max(w.z, 0.0));
  return vec2(w.x + w.y, w.x - w.y) * scale + 0.5;
}
