#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// First normals by central differences of the filtered depth (paper section 3.2), pointing away from the camera,
// and the support radius of each kernel (reference notes 1.4): radius_scale pixel diagonals, more on slanted surfaces.
#include "shaders/shared/frame.h"
#include "shaders/lib/geometry.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
layout(scalar, binding = 0) readonly buffer Depth { float depth_m[]; };
layout(scalar, binding = 1) writeonly buffer Normals { vec4 normal_radius[]; };
layout(scalar, push_constant) uniform Push { NormalParams p; };

vec3 vertex_at(ivec2 pixel) {
  if (!inside(p.camera, pixel)) return vec3(0.0);
  return pixel_ray(p.camera, vec2(pixel)) * depth_m[uint(pixel.y) * p.camera.width + uint(pixel.x)];
}

// Difference along one image axis: central where both sides lie on the same surface, else one-sided; zero where neither does.
vec3 difference(vec3 centre, ivec2 pixel, ivec2 axis) {
  vec3 behind = vertex_at(pixel - axis), ahead = vertex_at(pixel + axis);
  bool has_behind = behind.z > 0.0 && abs(behind.z - centre.z) < p.depth_gate_m;
  bool has_ahead = ahead.z > 0.0 && abs(ahead.z - centre.z) < p.depth_gate_m;
  return (has_ahead ? ahead : centre) - (has_behind ? behind : centre);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(p.camera, pixel)) return;
  uint index = uint(pixel.y) * p.camera.width + uint(pixel.x);
  vec3 centre = vertex_at(pixel);
  vec3 normal = cross(difference(centre, pixel, ivec2(1, 0)), difference(centre, pixel, ivec2(0, 1)));
  float length_squared = dot(normal, normal);
  if (centre.z <= 0.0 || length_squared < 1e-20) {
    normal_radius[index] = vec4(0.0);
    return;
  }
  normal *= inversesqrt(length_squared);
  float diagonal_m = sqrt(2.0) * centre.z / (0.5 * (p.camera.fx + p.camera.fy));
  normal_radius[index] = vec4(normal, p.radius_scale * diagonal_m / max(0.5, abs(normal.z)));
}
