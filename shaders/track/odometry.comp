#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Normal equations of one Gauss-Newton step: curvature-weighted point-to-plane terms against the predicted surface (paper Eq. 6-9) plus
// photometric terms against its colour (Eq. 10), linearised for reference_from_camera <- exp(x) reference_from_camera,
// x = (translation, rotation). One scale for both sides: H = H_rgb + w H_icp, b = b_rgb + w b_icp.
#include "shaders/shared/track.h"
#include "shaders/lib/geometry.glsl"
const uint kTerms = HERMITE_ODOMETRY_TERMS;
const uint kGroupSize = HERMITE_ODOMETRY_GROUP_SIZE;
layout(local_size_x = HERMITE_ODOMETRY_GROUP_SIZE) in;
layout(scalar, binding = 0) readonly buffer Depth { float depth_m[]; };
layout(scalar, binding = 1) readonly buffer Normals { vec4 normals[]; };
layout(scalar, binding = 2) readonly buffer Curvatures { vec2 curvatures[]; };
layout(scalar, binding = 3) readonly buffer Intensity { float intensity[]; };
layout(scalar, binding = 4) readonly buffer Gradient { vec2 gradient[]; };
layout(scalar, binding = 5) readonly buffer ReferenceDepth { float reference_depth_m[]; };
layout(scalar, binding = 6) readonly buffer ReferenceNormals { vec4 reference_normal_weight[]; };
layout(scalar, binding = 7) readonly buffer ReferenceCurvatures { vec2 reference_curvatures[]; };
layout(scalar, binding = 8) readonly buffer ReferenceIntensity { float reference_intensity[]; };
layout(scalar, binding = 9) writeonly buffer Sums { float partial_sums[]; };
layout(scalar, push_constant) uniform Push { OdometryParams p; };
#include "shaders/lib/sums.glsl"

float sums[kTerms];

void add_row(vec3 translation, vec3 rotation, float residual, float weight) {
  float row[6] = float[6](translation.x, translation.y, translation.z, rotation.x, rotation.y, rotation.z);
  uint k = 0u;
  for (uint i = 0u; i < 6u; ++i)
    for (uint j = i; j < 6u; ++j) sums[k++] += weight * row[i] * row[j];
  for (uint i = 0u; i < 6u; ++i) sums[21u + i] -= weight * row[i] * residual;
}

vec3 reference_vertex(ivec2 pixel, uint i) { return pixel_ray(p.camera, vec2(pixel)) * reference_depth_m[i]; }

// The pixel of the prediction that corresponds to a transformed point: the projected one, or the least dissimilar in a window (paper Eq. 6, 7).
uint correspond(ivec2 centre, vec3 point, vec3 normal, vec2 kappa) {
  int radius = int(p.search_radius);
  float farthest = 0.0;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      ivec2 q = centre + ivec2(dx, dy);
      if (!inside(p.camera, q)) continue;
      uint i = uint(q.y) * p.camera.width + uint(q.x);
      float d = distance(point, reference_vertex(q, i));
      if (d < p.distance_gate_m) farthest = max(farthest, d);
    }
  float best = 1e9;
  uint found = 0xffffffffu;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      ivec2 q = centre + ivec2(dx, dy);
      if (!inside(p.camera, q)) continue;
      uint i = uint(q.y) * p.camera.width + uint(q.x);
      float d = distance(point, reference_vertex(q, i));
      if (reference_depth_m[i] <= 0.0 || d >= p.distance_gate_m) continue;
      vec3 n = reference_normal_weight[i].xyz;
      float cosine = dot(n, normal);
      if (cosine <= 0.0 || dot(cross(n, normal), cross(n, normal)) > p.sine_normal_gate * p.sine_normal_gate) continue;
      vec2 k = reference_curvatures[i];
      float scale = max(max(abs(k.x), abs(k.y)), 1e-3);
      float dissimilarity = d / max(farthest, 1e-9) + (1.0 - cosine) + (1.0 - exp(-(abs(kappa.x - k.x) + abs(kappa.y - k.y)) / scale));
      if (radius == 0) dissimilarity = 0.0;
      if (dissimilarity < best) {
        best = dissimilarity;
        found = i;
      }
    }
  return found;
}

void add_geometry(ivec2 centre, vec3 s, uint i) {
  vec3 normal = rotate(p.reference_from_camera, normals[i].xyz);
  uint j = correspond(centre, s, normal, curvatures[i]);
  if (j == 0xffffffffu) return;
  vec4 n = reference_normal_weight[j];
  vec3 d = reference_vertex(ivec2(j % p.camera.width, j / p.camera.width), j);
  float residual = dot(n.xyz, s - d);
  add_row(n.xyz, cross(s, n.xyz), residual, p.geometric_weight * n.w);
  sums[27] += residual * residual;
  sums[28] += 1.0;
}

void add_photometry(vec2 uv, vec3 s, uint i) {
  vec2 g = gradient[i];
  if (dot(g, g) < p.gradient_min * p.gradient_min) return;
  ivec2 q = ivec2(floor(uv));
  if (q.x < 0 || q.y < 0 || q.x + 1 >= int(p.camera.width) || q.y + 1 >= int(p.camera.height)) return;
  uint j = uint(q.y) * p.camera.width + uint(q.x);
  float i00 = reference_intensity[j], i10 = reference_intensity[j + 1u];
  float i01 = reference_intensity[j + p.camera.width], i11 = reference_intensity[j + p.camera.width + 1u];
  if (min(min(i00, i10), min(i01, i11)) < 0.0) return;
  vec2 f = uv - vec2(q);
  uint nearest = j + (f.x >= 0.5 ? 1u : 0u) + (f.y >= 0.5 ? p.camera.width : 0u);
  float z = reference_depth_m[nearest];
  if (z <= 0.0 || abs(z - s.z) > p.photometric_depth_gate_m) return;
  float residual = intensity[i] - mix(mix(i00, i10, f.x), mix(i01, i11, f.x), f.y);
  vec2 scaled = g * vec2(p.camera.fx, p.camera.fy) / s.z;
  vec3 a = -vec3(scaled, -dot(scaled, s.xy) / s.z);
  float weight = 1.0 / (p.photometric_sigma + abs(residual));
  add_row(a, cross(s, a), residual, weight * weight);
  sums[29] += residual * residual;
  sums[30] += 1.0;
}

void main() {
  for (uint i = 0u; i < kTerms; ++i) sums[i] = 0.0;
  uint columns = p.camera.width / p.stride, rows = p.camera.height / p.stride;
  for (uint k = gl_GlobalInvocationID.x; k < columns * rows; k += HERMITE_ODOMETRY_GROUPS * kGroupSize) {
    ivec2 pixel = ivec2(k % columns, k / columns) * int(p.stride);
    uint i = uint(pixel.y) * p.camera.width + uint(pixel.x);
    float z = depth_m[i];
    if (z <= 0.0) continue;
    sums[31] += 1.0;
    vec3 s = transform_point(p.reference_from_camera, pixel_ray(p.camera, vec2(pixel)) * z);
    if (s.z < 0.05) continue;
    vec2 uv = project(p.camera, s);
    ivec2 centre = ivec2(floor(uv + 0.5));
    if (!inside(p.camera, centre)) continue;
    add_geometry(centre, s, i);
    add_photometry(uv, s, i);
  }
  write_group_sums(sums);
}
