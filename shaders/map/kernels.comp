#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Computes, once per pixel of the index map, the kernel of its surfel that prediction reads from
// all rays around it.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surfel.glsl"
#include "shaders/lib/kernels.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
TEXELS(0, position_confidence);
TEXELS(1, attributes);
TEXELS(2, camera_from_submap);
TEXELS(3, nearest);  // NearestSurfel
layout(scalar, binding = 4) writeonly buffer Kernels { uvec4 kernels[]; };
PARAMETERS(Intrinsics, camera);

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(camera, pixel)) return;
  uint slot = uvec2_at(nearest, uint(pixel.y) * camera.width + uint(pixel.x)).x;
  uvec4 words = uvec4(0u);
  if (slot != HERMITE_NONE) {
    SurfelAttributes a = attributes_at(attributes, slot);
    Transform t = transform_at(camera_from_submap, surfel_submap(a));
    vec3 normal = rotate(t, unpack_unit(a.normal));
    vec4 surfel = vec4_at(position_confidence, slot);
    if (normal.z >= 0.0 && surfel.w > 0.0) {
      vec3 position = transform_point(t, surfel.xyz);
      vec2 offset = project(camera, position) - vec2(pixel);
      words = uvec4(floatBitsToUint(position.z), packSnorm2x16(2.0 * offset), pack_normal(normal),
                    floatBitsToUint(1.0 / surfel_radius(a)));
    }
  }
  kernels[kernel_index(camera, pixel)] = words;
}
