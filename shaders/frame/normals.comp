#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Computes initial normals by central differences of the filtered depth (paper section 3.2),
// pointing away from the camera. With the depth they are the kernels of the frame's own HRBF.
#include "shaders/shared/frame.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/kernels.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
TEXELS(0, depth_m);
// Depth, normal, its z, inverse radius; zeros without a kernel.
layout(scalar, binding = 1) writeonly buffer Kernels { uvec4 kernels[]; };
PARAMETERS(NormalParams, p);

vec3 vertex_at(ivec2 pixel) {
  if (!inside(p.camera, pixel)) return vec3(0.0);
  return pixel_ray(p.camera, vec2(pixel)) *
         float_at(depth_m, uint(pixel.y) * p.camera.width + uint(pixel.x));
}

// Returns the difference along one image axis: central if both sides are on the same surface, else
// one-sided; zero if neither is.
vec3 difference(vec3 centre, ivec2 pixel, ivec2 axis) {
  vec3 behind = vertex_at(pixel - axis), ahead = vertex_at(pixel + axis);
  bool has_behind = behind.z > 0.0 && abs(behind.z - centre.z) < p.depth_gate_m;
  bool has_ahead = ahead.z > 0.0 && abs(ahead.z - centre.z) < p.depth_gate_m;
  return (has_ahead ? ahead : centre) - (has_behind ? behind : centre);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(p.camera, pixel)) return;
  vec3 centre = vertex_at(pixel);
  vec3 normal =
      cross(difference(centre, pixel, ivec2(1, 0)), difference(centre, pixel, ivec2(0, 1)));
  float length_squared = dot(normal, normal);
  bool valid = centre.z > 0.0 && length_squared > 1e-20 && normal.z > 0.0;
  uint packed_normal = pack_normal(normal * inversesqrt(length_squared));
  float normal_z = unpack_normal(packed_normal).z,
        inverse_radius = 1.0 / support_radius(p.camera, p.radius_scale, centre.z, normal_z);
  kernels[kernel_index(p.camera, pixel)] =
      valid ? uvec4(floatBitsToUint(centre.z), packed_normal, floatBitsToUint(normal_z),
                    floatBitsToUint(inverse_radius))
            : uvec4(0u);
}
