// A base material at a point of its mesh: factors times textures, as glTF 2.0 and its extensions define them.
#include "scene_interface.glsl"

layout(binding = 0) uniform sampler2D scene_textures[SCENE_TEXTURES];

layout(location = 0) in vec3 position_ws;
layout(location = 1) in vec3 normal_ws;
layout(location = 2) in vec4 tangent_ws;
layout(location = 3) in vec4 uv01;
layout(location = 4) in vec4 uv23;
layout(location = 5) in vec4 vertex_color;

bool hasTexture(int role) {
  return (base_material.flags.x & (1 << role)) != 0;
}

// The mesh's texture coordinates that a texture chooses.
vec2 uvOf(int role) {
  int set = int(base_material.image_u[role].w);
  vec4 pair = set < 2 ? uv01 : uv23;
  return (set & 1) == 0 ? pair.xy : pair.zw;
}

vec2 imagePoint(int role, vec2 uv) {
  vec3 point = vec3(uv, 1.0);
  return vec2(dot(base_material.image_u[role].xyz, point), dot(base_material.image_v[role].xyz, point));
}

// What the texture shows; white where there is none. `role` must be a constant.
#define SCENE_TEXEL(role) \
  (hasTexture(role) ? texture(scene_textures[role], imagePoint(role, uvOf(role))) : vec4(1.0))

// Linear base colour and alpha before the alpha mode.
vec4 baseColor() {
  return base_material.base_color * vertex_color * SCENE_TEXEL(SCENE_TEXTURE_BASE_COLOR);
}

// True where an alpha mask leaves nothing.
bool isMaskedOut(float alpha) {
  return (base_material.flags.y & SCENE_ALPHA_MASK) != 0 && alpha < base_material.emissive_cutoff.w;
}

// Unit columns along growing u, along growing v, and the normal of the front.
mat3 uvFrame(vec2 uv) {
  vec3 n = normalize(normal_ws);
  vec3 t = tangent_ws.xyz;
  float sign_ = tangent_ws.w * float(object.flags.z);
  if (abs(tangent_ws.w) < 0.5 || (object.flags.x & SCENE_DERIVE_TANGENTS) != 0) {
    vec3 px = dFdx(position_ws), py = dFdy(position_ws);
    vec2 ux = dFdx(uv), uy = dFdy(uv);
    float side = ux.x * uy.y - uy.x * ux.y < 0.0 ? -1.0 : 1.0;
    t = (px * uy.y - py * ux.y) * side;
    vec3 b = (py * ux.x - px * uy.x) * side;
    sign_ = dot(cross(n, t), b) < 0.0 ? -1.0 : 1.0;
  }
  t -= n * dot(n, t);
  if (dot(t, t) < 1e-20) t = abs(n.y) < 0.9 ? cross(vec3(0.0, 1.0, 0.0), n) : vec3(1.0, 0.0, 0.0);
  t = normalize(t);
  return mat3(t, sign_ * cross(n, t), n);
}

// A normal texture's normal; its green axis runs against v.
vec3 mappedNormal(vec4 texel, float scale, vec2 uv) {
  vec3 n = texel.xyz * 2.0 - 1.0;
  return normalize(uvFrame(uv) * vec3(n.x * scale, -n.y * scale, n.z));
}

// The side that is seen of surfaces with two sides.
float facing() {
  return !gl_FrontFacing && (object.flags.x & SCENE_DOUBLE_SIDED) != 0 ? -1.0 : 1.0;
}

struct BaseSurface {
  vec3 normal, coat_normal;  // world, unit
  vec3 diffuse;              // albedo of what is not reflected
  vec3 f0, f90;              // reflectance facing the surface, and along it
  float roughness;
  float occlusion;  // of light from all around
  vec3 sheen;
  float sheen_roughness;
  float coat, coat_roughness;
};

BaseSurface baseSurface(vec3 color) {
  BaseSurface s;
  vec4 metal_rough = SCENE_TEXEL(SCENE_TEXTURE_METALLIC_ROUGHNESS);
  float metallic = base_material.factors.x * metal_rough.b;
  s.roughness = clamp(base_material.factors.y * metal_rough.g, 0.03, 1.0);
  float strength = base_material.specular.w * SCENE_TEXEL(SCENE_TEXTURE_SPECULAR).a;
  vec3 tint = base_material.specular.rgb * SCENE_TEXEL(SCENE_TEXTURE_SPECULAR_COLOR).rgb;
  vec3 dielectric = min(base_material.clearcoat.w * tint, vec3(1.0)) * strength;
  s.f0 = mix(dielectric, color, metallic);
  s.f90 = vec3(mix(strength, 1.0, metallic));
  s.diffuse = color * (1.0 - metallic);
  s.occlusion = 1.0 + base_material.factors.w * (SCENE_TEXEL(SCENE_TEXTURE_OCCLUSION).r - 1.0);

  vec3 flat_normal = normalize(normal_ws);
  s.normal = flat_normal;
  if (hasTexture(SCENE_TEXTURE_NORMAL))
    s.normal =
        mappedNormal(SCENE_TEXEL(SCENE_TEXTURE_NORMAL), base_material.factors.z, uvOf(SCENE_TEXTURE_NORMAL));
  s.normal *= facing();

  s.sheen = base_material.sheen.rgb * SCENE_TEXEL(SCENE_TEXTURE_SHEEN_COLOR).rgb;
  s.sheen_roughness = clamp(base_material.sheen.a * SCENE_TEXEL(SCENE_TEXTURE_SHEEN_ROUGHNESS).a, 0.05, 1.0);

  s.coat = base_material.clearcoat.x * SCENE_TEXEL(SCENE_TEXTURE_CLEARCOAT).r;
  s.coat_roughness =
      clamp(base_material.clearcoat.y * SCENE_TEXEL(SCENE_TEXTURE_CLEARCOAT_ROUGHNESS).g, 0.03, 1.0);
  s.coat_normal = flat_normal;
  if (hasTexture(SCENE_TEXTURE_CLEARCOAT_NORMAL))
    s.coat_normal = mappedNormal(SCENE_TEXEL(SCENE_TEXTURE_CLEARCOAT_NORMAL), base_material.clearcoat.z,
                                 uvOf(SCENE_TEXTURE_CLEARCOAT_NORMAL));
  s.coat_normal *= facing();
  return s;
}

vec3 emittedLight() {
  return base_material.emissive_cutoff.rgb * SCENE_TEXEL(SCENE_TEXTURE_EMISSIVE).rgb;
}
