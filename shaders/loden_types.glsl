// What the library's functions pass to each other and to a renderer.

// State of one drawn instance, or of one shading point, next to the material's block.
struct LodenPoint {
  float lambda_min;    // finest level that is resident; finer requests show this one
  float lambda_bias;   // added to the footprint's lambda
  float distance_;     // above 0: lambda by LBTF's distance rule, in units at which a texel covers a pixel
  bool skip_parallax;  // fade the lookup out where parallax is below a quarter of a texel shown
  // What loden_follow_surface finds out; the defaults stand for a flat surface with unstretched texture
  // coordinates. The tile length is the square root of the area that a tile takes.
  mat2 curvature;  // of the reference surface: tilt of the normal per tile length, symmetric, positive if
                   // convex
  mat2 x_from_tangent;  // tile periods per tile length along the tangent frame; of determinant 1
  float tile_length;    // in the renderer's units; the library itself does not read it
};

// The local reflectance at one point, filtered (loden_near.glsl).
struct LodenNear {
  vec3 mapped;     // mean normal, not longer than 1
  vec3 normal;     // the same of unit length
  vec3 diffuse;    // albedo
  vec3 f0;         // GGX: reflectance at normal incidence
  float strength;  // Phong: value at the lobe's peak
  float width;     // Phong: exponent; GGX: alpha
#ifdef LODEN_VISIBILITY_MAP
  vec4 shadow[LODEN_VISIBILITY_MAP];  // of the shadow map
#endif
#ifdef LODEN_INDIRECT
  vec3 indirect_color;  // of C
  vec4 indirect;        // C over its colour and wi.z: coefficients of 1, wi.z, wi.x, wi.y
#endif
};

// One shading point, shared by all lights.
struct LodenHit {
  vec2 x;        // reference domain, tile periods
  vec2 p;        // parameter domain
  float lambda;  // level of detail
  float depth;   // height of the hit over the tangent plane at x, tile lengths, <= 0
  vec2 tilt;     // of the surface's normal there against that at x, on a curved surface
  bool missed;   // the ray goes by a convex surface without meeting the tile: what stands behind it is seen
  // Of the near term, and of the lookup towards the light:
  float near_weight;
  LodenNear near;  // where near_weight > 0
  vec3 position;   // tile periods; z in tile lengths below the reference surface
  bool relief;     // position is a point of the tile's geometry
  mat2 curvature;  // as in LodenPoint
  mat2 x_from_tangent;
};
