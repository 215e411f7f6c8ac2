#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Evaluates the Hermite RBF implicit of the frame in a 7x7 window (paper Eq. 2-5): moves each
// vertex along its ray to the zero set, and computes the normal from the gradient, principal
// curvatures from gradient and Hessian, and the confidence c = c_r c_d. Normals point away from the
// camera, so surfaces that bulge towards it have positive curvature.
#include "shaders/shared/frame.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/fours.glsl"
#include "shaders/lib/hermite.glsl"
#include "shaders/lib/kernels.glsl"
#include "shaders/lib/surface_point.glsl"
layout(local_size_x = 8, local_size_y = 16) in;  // four neighbouring pixels per invocation
TEXELS(0, kernels);
layout(scalar, binding = 1) writeonly buffer Points { SurfacePoint points[]; };
PARAMETERS(SurfaceParams, p);

const int kRadius = 3;
const uint kMinKernels = 16;  // of 49, as in the authors' program

vec2 inverse_focal = 1.0 / vec2(p.camera.fx, p.camera.fy);

struct Field {
  Vectors4 gradient;
  Hessian4 hessian;
  vec4 count;  // kernels that contribute
};

// `first` is the index of the window's corner for the first pixel; `ray` belongs to that pixel's
// centre.
Kernel kernel_at(int first, int dx, int dy, vec3 ray) {
  uvec4 words = uvec4_at(kernels, uint(first + dy * kernel_stride(p.camera) + dx));
  vec3 position = uintBitsToFloat(words.x) *
                  (ray + vec3(vec2(dx - kRadius, dy - kRadius) * inverse_focal, 0.0));
  return Kernel(position, vec3(unpack_snorm(words.y), uintBitsToFloat(words.z)),
                inverse_radius_of(words.w));
}

// Returns 1 where the kernel of column dx is in the pixel's window and on the same surface as its
// vertex; else 0.
vec4 admits(int dx, Kernel k, vec4 vertex_z) {
  vec4 near = vec4(lessThan(abs(k.position.z - vertex_z), vec4(p.depth_gate_m)));
  return in_windows(dx, kRadius) * near * (k.inverse_radius < kNoKernel ? 1.0 : 0.0);
}

// One step along the rays from the pixels' vertices.
vec4 step_to_surface(int first, Rays4 rays, vec4 vertex_z) {
  Step4 sums = Step4(vec4(0.0), vec4(0.0));
  Vectors4 x = points_at(rays, vertex_z);
  for (int dy = 0; dy <= 2 * kRadius; ++dy) {
    [[unroll]] for (int dx = 0; dx <= 2 * kRadius + 3; ++dx) {
      Kernel k = kernel_at(first, dx, dy, first_ray(rays));
      vec4 w = step_weight(k, offset_from(k, x)) * admits(dx, k, vertex_z);
      add_plane(sums, w, vec4(dot(k.normal, k.position)), dot4(k.normal, rays));
    }
  }
  return step_to(sums, vertex_z);
}

// Evaluates the field at the points t * ray, on the surface of the pixels' vertices.
Field evaluate(int first, Rays4 rays, vec4 vertex_z, vec4 t) {
  const vec4 kZero = vec4(0.0);
  Field f = Field(Vectors4(kZero, kZero, kZero), Hessian4(kZero, kZero, kZero, kZero, kZero, kZero),
                  kZero);
  Vectors4 x = points_at(rays, t);
  for (int dy = 0; dy <= 2 * kRadius; ++dy) {
    [[unroll]] for (int dx = 0; dx <= 2 * kRadius + 3; ++dx) {
      Kernel k = kernel_at(first, dx, dy, first_ray(rays));
      Offset4 offset = offset_from(k, x);
      vec4 admitted = admits(dx, k, vertex_z);
      f.count += admitted * reaches(offset);
      add_gradient(f.gradient, k, offset, admitted);
      vec4 other =
          vec4(notEqual(ivec4(dx), kRadius + ivec4(0, 1, 2, 3))) + (dy != kRadius ? 1.0 : 0.0);
      add_hessian(f.hessian, k, offset, admitted * min(other, 1.0));
    }
  }
  return f;
}

// The confidence c = c_r c_d.
float confidence_at(ivec2 pixel, float gradient) {
  vec2 half_size = 0.5 * vec2(p.camera.width, p.camera.height);
  vec2 offset = vec2(pixel) - vec2(p.camera.cx, p.camera.cy);
  // 0.72 is 2 sigma^2, with sigma = 0.6 (Keller et al. 2013).
  float c_d = exp(-dot(offset, offset) / dot(half_size, half_size) / 0.72);
  return p.use_hrbf_confidence != 0u
             ? c_d * reconstruction_confidence(gradient, p.confidence_epsilon)
             : c_d;
}

void write(ivec2 pixel, float z, vec3 gradient, vec3 diagonal, vec3 mixed, float count,
           vec3 first_normal) {
  uint index = uint(pixel.y) * p.camera.width + uint(pixel.x);
  vec2 kappa = principal_curvatures(gradient, diagonal, mixed);
  // A back side cannot be visible.
  bool facing = gradient.z > 0.0 && dot(gradient, pixel_ray(p.camera, vec2(pixel))) > 0.0;
  bool valid = z > 0.0 && count >= float(kMinKernels) && facing &&
               abs(kappa.x) < p.curvature_limit_per_m && abs(kappa.y) < p.curvature_limit_per_m;
  float confidence = confidence_at(pixel, abs(dot(gradient, first_normal)));
  points[index] =
      valid ? SurfacePoint(z, pack_normal(normalize(gradient)), packHalf2x16(kappa), confidence)
            : kNoPoint;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.x * 4u, gl_GlobalInvocationID.y);
  if (!inside(p.camera, pixel)) return;
  int first = kernel_index(p.camera, pixel - kRadius);
  uint centre = uint(kernel_index(p.camera, pixel));
  vec3 ray = pixel_ray(p.camera, vec2(pixel));
  Rays4 rays = rays_from(p.camera, ray);
  vec4 vertex_z = vec4(vec4_at(kernels, centre).x, vec4_at(kernels, centre + 1u).x,
                       vec4_at(kernels, centre + 2u).x, vec4_at(kernels, centre + 3u).x);
  vec4 z = vertex_z;
  if (p.project_to_surface != 0u) {
    vec4 moved = step_to_surface(first, rays, vertex_z);
    // Half a frontal support radius; farther away is another surface.
    vec4 limit = 0.5 * p.radius_scale * 2.8284271 / (p.camera.fx + p.camera.fy) * z;
    z = mix(z, moved, lessThan(abs(moved - z), limit));
  }
  Field f = evaluate(first, rays, vertex_z, z);
  for (int i = 0; i < 4; ++i) {
    ivec2 q = pixel + ivec2(i, 0);
    if (!inside(p.camera, q)) continue;
    vec3 diagonal = vec3(f.hessian.xx[i], f.hessian.yy[i], f.hessian.zz[i]);
    vec3 mixed = vec3(f.hessian.xy[i], f.hessian.xz[i], f.hessian.yz[i]);
    write(q, z[i], component(f.gradient, i), diagonal, mixed, f.count[i],
          unpack_normal(uvec4_at(kernels, centre + uint(i)).y));
  }
}
