#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
// Predicts the surface from a pose (paper section 3.1): it intersects each pixel's ray with the
// zero set of the Hermite RBF implicit of the surfels in a window of the index map, by
// weighted-plane steps along the ray (core/METHOD.md, "Step along the ray") instead of bisection.
// Attributes are those of the kernel nearest to the solution. With hrbf == 0 it takes the nearest
// surfel disc that the ray hits. Each invocation computes four neighbouring pixels.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surfel.glsl"
#include "shaders/lib/weight.glsl"
#include "shaders/lib/fours.glsl"
#include "shaders/lib/hermite.glsl"
#include "shaders/lib/kernels.glsl"
#include "shaders/lib/surface_point.glsl"
layout(local_size_x = 8, local_size_y = 16) in;
layout(constant_id = 0) const int kRadius = 3;  // window of 2 kRadius + 1
TEXELS(0, position_confidence);
TEXELS(1, attributes);
TEXELS(2, kernels);
TEXELS(3, nearest);  // NearestSurfel
layout(scalar, binding = 4) writeonly buffer Points { SurfacePoint points[]; };
layout(scalar, binding = 5) writeonly buffer Intensity { float intensity[]; };
layout(scalar, binding = 6) buffer Covered { uint covered_count; };
PARAMETERS(PredictParams, p);

vec2 inverse_focal = 1.0 / vec2(p.camera.fx, p.camera.fy);

// `first` is the index of the window's corner for the first pixel; `ray` belongs to that pixel's
// centre.
Kernel kernel_at(int first, int dx, int dy, vec3 ray) {
  uvec4 words = uvec4_at(kernels, uint(first + dy * kernel_stride(p.camera) + dx));
  vec2 offset = vec2(float(dx - kRadius), float(dy - kRadius)) + 0.5 * unpack_snorm(words.y);
  vec3 direction = ray + vec3(offset * inverse_focal, 0.0);
  return Kernel(uintBitsToFloat(words.x) * direction, unpack_normal(words.z),
                inverse_radius_of(words.w));
}

struct Field {
  Vectors4 gradient;
  vec4 support;        // kernels that contribute
  vec4 nearest;        // squared distance of the nearest kernel [m^2]
  uvec4 nearest_cell;  // its dx | dy << 8 in the first pixel's window
};

// One step along the rays from the depths t; 0 where no kernel supports the point. If `is_between`,
// a literal, plane normals are interpolated with `mid` by `mid_share`.
vec4 step_to_surface(int first, Rays4 rays, vec4 t, bool is_between, Vectors4 mid,
                     float mid_share) {
  Step4 sums = Step4(vec4(0.0), vec4(0.0));
  Vectors4 x = points_at(rays, t);
  vec4 mid_slope = dot4(mid, rays);
  for (int dy = 0; dy <= 2 * kRadius; ++dy) {
    [[unroll]] for (int dx = 0; dx <= 2 * kRadius + 3; ++dx) {
      Kernel k = kernel_at(first, dx, dy, first_ray(rays));
      vec4 w = step_weight(k, offset_from(k, x)) * in_windows(dx, kRadius);
      vec4 plane = vec4(dot(k.normal, k.position)), slope = dot4(k.normal, rays);
      if (is_between) plane = mix(plane, dot4(mid, k.position), mid_share);
      if (is_between) slope = mix(slope, mid_slope, mid_share);
      add_plane(sums, w, plane, slope);
    }
  }
  return step_to(sums, vec4(0.0));
}

// Evaluates the field at the points t * ray.
Field evaluate(int first, Rays4 rays, vec4 t) {
  const vec4 kZero = vec4(0.0);
  Field f = Field(Vectors4(kZero, kZero, kZero), kZero, vec4(1e9), uvec4(HERMITE_NONE));
  Vectors4 x = points_at(rays, t);
  for (int dy = 0; dy <= 2 * kRadius; ++dy) {
    [[unroll]] for (int dx = 0; dx <= 2 * kRadius + 3; ++dx) {
      Kernel k = kernel_at(first, dx, dy, first_ray(rays));
      Offset4 offset = offset_from(k, x);
      vec4 in_window = in_windows(dx, kRadius);
      add_gradient(f.gradient, k, offset, in_window);
      f.support += in_window * reaches(offset);
      vec4 d2 = square4(offset.v);
      bvec4 closer =
          lessThan(mix(vec4(1e9), d2, bvec4(uvec4(in_window) * uint(k.inverse_radius < kNoKernel))),
                   f.nearest);
      f.nearest = mix(f.nearest, d2, closer);
      f.nearest_cell = mix(f.nearest_cell, uvec4(dx | (dy << 8)), closer);
    }
  }
  return f;
}

float depth_at(int first, int dx, int dy) {
  return vec4_at(kernels, uint(first + dy * kernel_stride(p.camera) + dx)).x;
}

// Returns the initial depth: of the pixel's own surfel, or else the nearest one in the window.
float first_guess(int first, int pixel) {
  float depth = depth_at(first, pixel + kRadius, kRadius);
  if (depth > 0.0) return depth;
  float nearest = 1e9;
  for (int dy = 0; dy <= 2 * kRadius; ++dy)
    for (int dx = 0; dx <= 2 * kRadius; ++dx) {
      float z = depth_at(first, pixel + dx, dy);
      nearest = z > 0.0 ? min(nearest, z) : nearest;
    }
  return nearest < 1e9 ? nearest : 0.0;
}

// Returns the depths where the rays hit the zero set; 0 where they do not.
vec4 intersect_hrbf(int first, Rays4 rays, out Vectors4 normals, out uvec4 cells) {
  vec4 t;
  for (int i = 0; i < 4; ++i) t[i] = first_guess(first, i);
  normals = Vectors4(vec4(0.0), vec4(0.0), vec4(0.0));
  cells = uvec4(HERMITE_NONE);
  if (all(equal(t, vec4(0.0)))) return t;
  for (uint i = 0u; i < p.max_iterations; ++i)
    t = step_to_surface(first, rays, t, false, normals, 0.0);
  Field f = evaluate(first, rays, t);
  normals = unit4(f.gradient);
  cells = f.nearest_cell;
  // The zero set is off a curved surface by about 0.07 H r^2 (core/math/hrbf.h); planes with the
  // mean of both normals remove that bias.
  vec4 solution = step_to_surface(first, rays, t, true, normals, p.correct_bias != 0u ? 0.5 : 0.0);
  // A solution that still moves by 0.2 % of its depth has no surface; the bias correction is
  // smaller than that.
  bvec4 settled = lessThan(abs(solution - t), 0.002 * t);
  bvec4 supported = greaterThanEqual(f.support, vec4(float(p.min_support)));
  bvec4 facing = greaterThan(min(normals.z, dot4(normals, rays)), vec4(0.0));
  return mix(vec4(0.0), solution, bvec4(uvec4(settled) * uvec4(supported) * uvec4(facing)));
}

// Returns the depth of the nearest disc that the ray hits, as splatted by Keller et al. 2013.
float intersect_disc(int first, vec3 ray, out vec3 normal, out uint cell) {
  float t = 1e9;
  normal = vec3(0.0);
  cell = HERMITE_NONE;
  for (int dy = 0; dy <= 2 * kRadius; ++dy)
    for (int dx = 0; dx <= 2 * kRadius; ++dx) {
      Kernel k = kernel_at(first, dx, dy, ray);
      float slope = dot(k.normal, ray);
      if (k.inverse_radius >= kNoKernel || slope <= 0.1) continue;
      float candidate = dot(k.normal, k.position) / slope;
      vec3 v = candidate * ray - k.position;
      // The support of a kernel spans 2.5 pixel diagonals, that of a splat one.
      if (candidate < t && dot(v, v) * (k.inverse_radius * k.inverse_radius) < 0.16) {
        t = candidate;
        normal = k.normal;
        cell = uint(dx | (dy << 8));
      }
    }
  return t < 1e9 ? t : 0.0;
}

// Returns whether there is a surface. `cell` counts from the window's corner of `pixel`.
bool write(ivec2 pixel, float z, vec3 normal, uint cell) {
  uint index = uint(pixel.y) * p.camera.width + uint(pixel.x);
  bool is_covered = z > 0.0 && cell != HERMITE_NONE;
  cell = is_covered ? cell : 0u;
  ivec2 source = pixel + ivec2(int(cell & 255u), int(cell >> 8)) - kRadius;
  uint slot = uvec2_at(nearest, uint(source.y) * p.camera.width + uint(source.x)).x;
  SurfelAttributes a = attributes_at(attributes, slot);
  float weight = tracking_weight(unpackHalf2x16(a.curvatures),
                                 vec4_at(position_confidence, slot).w * p.confidence_scale,
                                 p.curvature_lambda_per_m, z);
  points[index] =
      is_covered ? SurfacePoint(z, pack_normal(normal), a.curvatures, weight) : kNoPoint;
  intensity[index] = is_covered ? grey(surfel_color(a)) : -1.0;
  return is_covered;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.x * 4u, gl_GlobalInvocationID.y);
  if (!inside(p.camera, pixel)) return;
  int first = kernel_index(p.camera, pixel - kRadius);
  vec3 ray = pixel_ray(p.camera, vec2(pixel));
  vec4 z = vec4(0.0);
  Vectors4 n = Vectors4(vec4(0.0), vec4(0.0), vec4(0.0));
  uvec4 cells = uvec4(HERMITE_NONE);
  if (p.hrbf != 0u) {
    z = intersect_hrbf(first, rays_from(p.camera, ray), n, cells);
  } else {
    for (int i = 0; i < 4; ++i) {
      vec3 normal;
      uint cell;
      z[i] = intersect_disc(first + i, ray + vec3(float(i) / p.camera.fx, 0.0, 0.0), normal, cell);
      n.x[i] = normal.x;
      n.y[i] = normal.y;
      n.z[i] = normal.z;
      cells[i] = cell == HERMITE_NONE ? HERMITE_NONE : cell + uint(i);
    }
  }
  uint covered = 0u;
  for (int i = 0; i < 4; ++i) {
    ivec2 q = pixel + ivec2(i, 0);
    // The cells count from the first pixel's window.
    if (inside(p.camera, q) && write(q, z[i], component(n, i),
                                     cells[i] == HERMITE_NONE ? HERMITE_NONE : cells[i] - uint(i)))
      ++covered;
  }
  atomicAdd(covered_count, covered);
}
