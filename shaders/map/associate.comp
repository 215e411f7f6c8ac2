#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Associates each pixel's measurement with a surfel (paper section 5): in a 3x3 window of the index
// map, with gates on depth along the ray and on the normal, the surfel nearest to the ray wins. If
// several pixels match one surfel, the claim of its cell goes to the closest pixel, then to the one
// with the lowest index, whatever the order of threads.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surfel.glsl"
#include "shaders/lib/fuse_bindings.glsl"
layout(local_size_x = 256) in;
TEXELS(10, cells);  // IndexCell
layout(scalar, binding = 11) buffer Claims { uint claims[]; };

uint claim_key(float distance_px, uint i) {
  return (min(uint(distance_px * 256.0), 1023u) << kPixelBits) | i;
}

void main() {
  uint i = pixel_index();
  if (i == HERMITE_NONE) return;
  SurfacePoint point = point_at(frame_points, i);
  if (!can_be_fused(point, i)) {
    candidates[i] = HERMITE_NONE;
    return;
  }
  ivec2 pixel = pixel_of(i);
  vec3 ray = pixel_ray(p.camera, vec2(pixel));
  float ray_length = length(ray);
  float z = fused_depth_m(point, i);
  vec3 normal = unpack_normal(point.normal);
  uint best_cell = kNew;
  float best = 1e9;
  [[unroll]] for (int dy = -1; dy <= 1; ++dy) {
    [[unroll]] for (int dx = -1; dx <= 1; ++dx) {
      ivec2 q = pixel + ivec2(dx, dy);
      if (!inside(p.camera, q)) continue;
      uint cell = uint(q.y) * p.camera.width + uint(q.x);
      uvec4 shown = uvec4_at(cells, cell);
      if (shown.x == HERMITE_NONE) continue;
      float surfel_z = uintBitsToFloat(shown.y);
      if (abs(surfel_z - z) * ray_length > p.depth_gate_m) continue;
      vec3 n = unpack_unit(shown.w);
      if (abs(n.z) >= 0.75 && dot(n, normal) < p.cos_normal_gate) continue;
      vec3 position = surfel_z * pixel_ray(p.camera, vec2(q) + 0.5 * unpackSnorm2x16(shown.z));
      float distance_px = length(cross(position, ray)) / ray_length * p.camera.fx / z;
      if (distance_px < best) {
        best = distance_px;
        best_cell = cell;
      }
    }
  }
  candidates[i] = best_cell != kNew || p.add_new != 0u ? best_cell : HERMITE_NONE;
  if (best_cell != kNew) atomicMin(claims[best_cell], claim_key(best, i));
}
