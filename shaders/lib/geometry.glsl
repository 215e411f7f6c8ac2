// Rigid transforms, pinhole projection, packing.
vec3 transform_point(Transform t, vec3 p) {
  return vec3(dot(t.row0.xyz, p) + t.row0.w, dot(t.row1.xyz, p) + t.row1.w,
              dot(t.row2.xyz, p) + t.row2.w);
}
vec3 rotate(Transform t, vec3 v) {
  return vec3(dot(t.row0.xyz, v), dot(t.row1.xyz, v), dot(t.row2.xyz, v));
}
vec3 rotate_back(Transform t, vec3 v) {
  return v.x * t.row0.xyz + v.y * t.row1.xyz + v.z * t.row2.xyz;
}
vec3 transform_back(Transform t, vec3 p) {
  return rotate_back(t, p - vec3(t.row0.w, t.row1.w, t.row2.w));
}

// Returns the point of pixel (x, y) with z = 1.
vec3 pixel_ray(Intrinsics c, vec2 pixel) {
  return vec3((pixel.x - c.cx) / c.fx, (pixel.y - c.cy) / c.fy, 1.0);
}
vec2 project(Intrinsics c, vec3 p) {
  return vec2(c.fx * p.x / p.z + c.cx, c.fy * p.y / p.z + c.cy);
}
uvec2 sampled_size(Intrinsics c, Sampling s) { return uvec2(c.width, c.height) / s.step; }
ivec2 pixel_of_sample(Sampling s, uvec2 i) { return ivec2(s.step * i + uvec2(s.x, s.y)); }
bool inside(Intrinsics c, ivec2 pixel) {
  return pixel.x >= 0 && pixel.y >= 0 && pixel.x < int(c.width) && pixel.y < int(c.height);
}

// Octahedral unit vectors (Cigolle et al. 2014), 2 x snorm16.
vec2 sign_not_zero(vec2 v) { return vec2(v.x >= 0.0 ? 1.0 : -1.0, v.y >= 0.0 ? 1.0 : -1.0); }
uint pack_unit(vec3 n) {
  vec2 p = n.xy / (abs(n.x) + abs(n.y) + abs(n.z));
  if (n.z < 0.0) p = (1.0 - abs(p.yx)) * sign_not_zero(p);
  return packSnorm2x16(p);
}
vec3 unpack_unit(uint packed) {
  vec2 p = unpackSnorm2x16(packed);
  vec3 n = vec3(p, 1.0 - abs(p.x) - abs(p.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * sign_not_zero(n.xy);
  return normalize(n);
}

// Unit vectors with z >= 0, such as normals that point away from the camera: x and y as 2 x
// snorm16. One word keeps the maps small.
const uint kNoNormal = 0x80008000u;  // (-1, -1) is not part of a unit vector
uint pack_normal(vec3 n) { return packSnorm2x16(n.xy); }
// Like unpackSnorm2x16, without its divisions and clamps.
vec2 unpack_snorm(uint packed) {
  return vec2(ivec2(int(packed << 16) >> 16, int(packed) >> 16)) * (1.0 / 32767.0);
}
vec3 unpack_normal(uint packed) {
  vec2 xy = unpack_snorm(packed);
  return vec3(xy, sqrt(max(0.0, 1.0 - dot(xy, xy))));
}

// Returns the support radius of a measurement: `scale` pixel diagonals at its depth, up to twice
// that on slanted surfaces.
float support_radius(Intrinsics c, float scale, float depth_m, float normal_z) {
  return scale * 2.8284271 * depth_m / ((c.fx + c.fy) * max(0.5, normal_z));
}
