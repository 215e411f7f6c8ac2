// For tests/core/frame/hermite_test.cpp: all of lib/hermite.glsl at four points per invocation,
// with a list of kernels.
#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#include "shaders/shared/types.h"
#include "shaders/lib/fours.glsl"
#include "shaders/lib/hermite.glsl"
layout(local_size_x = 1) in;
layout(scalar, binding = 0) readonly buffer Kernels { Kernel kernels[]; };
// x and y of the ray, depth of the point; four have the same y.
layout(scalar, binding = 1) readonly buffer Rays { vec3 rays[]; };
struct Sample {
  float value;
  vec3 gradient, diagonal, mixed;
  float support, step;
  vec2 curvatures;
  float confidence;
};
layout(scalar, binding = 2) writeonly buffer Samples { Sample samples[]; };
layout(scalar, push_constant) uniform Params {
  uint kernel_count;
  uint own;  // the kernel whose Hessian is left out
} params;

void main() {
  uint first = 4u * gl_GlobalInvocationID.x;
  Rays4 four =
      Rays4(vec4(rays[first].x, rays[first + 1u].x, rays[first + 2u].x, rays[first + 3u].x),
            rays[first].y);
  vec4 t = vec4(rays[first].z, rays[first + 1u].z, rays[first + 2u].z, rays[first + 3u].z);
  const vec4 kZero = vec4(0.0), kAll = vec4(1.0);
  vec4 value = kZero, support = kZero;
  Vectors4 gradient = Vectors4(kZero, kZero, kZero);
  Hessian4 hessian = Hessian4(kZero, kZero, kZero, kZero, kZero, kZero);
  Step4 sums = Step4(kZero, kZero);
  for (uint j = 0u; j < params.kernel_count; ++j) {
    Kernel k = kernels[j];
    Offset4 offset = offset_from(k, points_at(four, t));
    support += reaches(offset);
    add_value(value, k, offset, kAll);
    add_gradient(gradient, k, offset, kAll);
    if (j != params.own) add_hessian(hessian, k, offset, kAll);
    add_plane(sums, step_weight(k, offset), vec4(dot(k.normal, k.position)), dot4(k.normal, four));
  }
  vec4 step = step_to(sums, kZero);
  for (int i = 0; i < 4; ++i) {
    vec3 g = component(gradient, i);
    vec3 diagonal = vec3(hessian.xx[i], hessian.yy[i], hessian.zz[i]),
         mixed = vec3(hessian.xy[i], hessian.xz[i], hessian.yz[i]);
    samples[first + uint(i)] = Sample(value[i], g, diagonal, mixed, support[i], step[i],
                                      principal_curvatures(g, diagonal, mixed),
                                      reconstruction_confidence(abs(g.z), 1000.0));
  }
}
