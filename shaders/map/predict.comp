#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The surface seen from a pose (paper section 3.1): each pixel's ray is met with the zero set of the Hermite RBF implicit of the surfels
// in a window of the index map. Weighted-plane iteration along the ray (core/METHOD.md, "Step along the ray") instead of a bisection.
// Attributes come from the kernel nearest to the solution. With hrbf == 0: the nearest surfel disc that the ray meets.
// Each invocation answers four neighbouring pixels (the components of a vec4), so that a kernel is loaded and unpacked once for all of them.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surfel.glsl"
#include "shaders/lib/weight.glsl"
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

const uint kNone = 0xffffffffu;

struct Kernel {
  vec3 position, normal;
  float inverse_radius;  // kNoKernel: there is none
};
vec2 inverse_focal = 1.0 / vec2(p.camera.fx, p.camera.fy);

// `first` is the index of the window's corner for the first pixel, `ray` belongs to its centre.
Kernel kernel_at(int first, int dx, int dy, vec3 ray) {
  uvec4 words = uvec4_at(kernels, uint(first + dy * kernel_stride(p.camera) + dx));
  vec2 offset = vec2(float(dx - kRadius), float(dy - kRadius)) + 0.5 * unpack_snorm(words.y);
  vec3 direction = ray + vec3(offset * inverse_focal, 0.0);
  return Kernel(uintBitsToFloat(words.x) * direction, unpack_normal(words.z), inverse_radius_of(words.w));
}

// Rays of the four pixels: (x, y, 1).
struct Rays {
  vec4 x;
  float y;
};

struct Normals4 {
  vec4 x, y, z;
};

struct Field {
  Normals4 gradient;    // proportional to the gradient of f
  vec4 support;         // kernels that contribute
  vec4 nearest;         // squared distance of the nearest kernel [m^2]
  uvec4 nearest_cell;   // its dx | dy << 8 in the first pixel's window
};

vec4 window_mask(int dx) {
  vec4 column = float(dx) - vec4(0.0, 1.0, 2.0, 3.0);
  return step(0.0, column) * step(column, vec4(2.0 * kRadius));
}

// One weighted-plane step from t: sum(w n.p) / sum(w n.d), w = s^3 / r^2; 0 where nothing supports the point.
// The planes' normals are mixed with `mid` by `share`.
vec4 step_to_surface(int first, Rays rays, vec4 t, Normals4 mid, float share) {
  vec4 plane = vec4(0.0), slope = vec4(0.0);
  vec3 ray = vec3(rays.x.x, rays.y, 1.0);
  vec4 x = t * rays.x, y = t * rays.y;
  vec4 mid_slope = mid.x * rays.x + mid.y * rays.y + mid.z;
  for (int dy = 0; dy <= 2 * kRadius; ++dy) {
    for (int dx = 0; dx <= 2 * kRadius + 3; ++dx) {
      Kernel k = kernel_at(first, dx, dy, ray);
      vec4 vx = x - k.position.x, vy = y - k.position.y, vz = t - k.position.z;
      vec4 s = max(1.0 - sqrt(vx * vx + vy * vy + vz * vz) * k.inverse_radius, 0.0);
      vec4 w = s * s * s * (k.inverse_radius * k.inverse_radius) * window_mask(dx);
      vec4 mid_plane = mid.x * k.position.x + mid.y * k.position.y + mid.z * k.position.z;
      plane += w * mix(vec4(dot(k.normal, k.position)), mid_plane, share);
      slope += w * mix(k.normal.x * rays.x + (k.normal.y * rays.y + k.normal.z), mid_slope, share);
    }
  }
  return mix(vec4(0.0), plane / slope, greaterThan(slope, vec4(0.0)));
}

// Gradient, support and nearest kernel at the points t * ray.
Field evaluate(int first, Rays rays, vec4 t) {
  const vec4 kZero = vec4(0.0);
  Field f = Field(Normals4(kZero, kZero, kZero), kZero, vec4(1e9), uvec4(kNone));
  vec3 ray = vec3(rays.x.x, rays.y, 1.0);
  vec4 x = t * rays.x, y = t * rays.y;
  for (int dy = 0; dy <= 2 * kRadius; ++dy) {
    for (int dx = 0; dx <= 2 * kRadius + 3; ++dx) {
      Kernel k = kernel_at(first, dx, dy, ray);
      vec4 vx = x - k.position.x, vy = y - k.position.y, vz = t - k.position.z;
      float weight = k.inverse_radius * k.inverse_radius;
      vec4 in_window = window_mask(dx);
      vec4 d2 = vx * vx + vy * vy + vz * vz;
      vec4 rho = sqrt(d2) * k.inverse_radius;
      vec4 s = max(1.0 - rho, 0.0) * in_window;
      vec4 w = s * s * weight;
      vec4 along = w * (3.0 * weight) / max(rho, 1e-4) * (k.normal.x * vx + k.normal.y * vy + k.normal.z * vz);
      w *= s;
      f.support += sign(s);
      f.gradient.x += w * k.normal.x - along * vx;
      f.gradient.y += w * k.normal.y - along * vy;
      f.gradient.z += w * k.normal.z - along * vz;
      bvec4 closer = lessThan(mix(vec4(1e9), d2, bvec4(uvec4(in_window) * uint(k.inverse_radius < kNoKernel))), f.nearest);
      f.nearest = mix(f.nearest, d2, closer);
      f.nearest_cell = mix(f.nearest_cell, uvec4(dx | (dy << 8)), closer);
    }
  }
  return f;
}

float depth_at(int first, int dx, int dy) { return vec4_at(kernels, uint(first + dy * kernel_stride(p.camera) + dx)).x; }

// Depth to start from: of the pixel's own surfel, or the nearest in the window where it has none.
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

Normals4 unit(vec4 x, vec4 y, vec4 z) {
  vec4 scale = inversesqrt(max(x * x + y * y + z * z, 1e-30));
  return Normals4(x * scale, y * scale, z * scale);
}

// Where the rays meet the zero set; 0 where they do not.
vec4 intersect_hrbf(int first, Rays rays, out Normals4 normals, out uvec4 cells) {
  vec4 t;
  for (int i = 0; i < 4; ++i) t[i] = first_guess(first, i);
  normals = Normals4(vec4(0.0), vec4(0.0), vec4(0.0));
  cells = uvec4(kNone);
  if (all(equal(t, vec4(0.0)))) return t;
  for (uint i = 0u; i < p.max_iterations; ++i) t = step_to_surface(first, rays, t, normals, 0.0);
  Field f = evaluate(first, rays, t);
  normals = unit(f.gradient.x, f.gradient.y, f.gradient.z);
  cells = f.nearest_cell;
  // The zero set lies off a curved surface by about 0.075 H r^2; planes with the mean of both normals remove that (notes 8.2.4).
  vec4 solution = step_to_surface(first, rays, t, normals, p.correct_bias != 0u ? 0.5 : 0.0);
  // A point that still moves by a millimetre or so has no surface under it: the bias is smaller than that.
  bvec4 settled = lessThan(abs(solution - t), 0.002 * t);
  bvec4 supported = greaterThanEqual(f.support, vec4(float(p.min_support)));
  bvec4 facing = greaterThan(min(normals.z, normals.x * rays.x + normals.y * rays.y + normals.z), vec4(0.0));
  return mix(vec4(0.0), solution, bvec4(uvec4(settled) * uvec4(supported) * uvec4(facing)));
}

// The nearest disc that the ray meets, as Keller et al. 2013 splat them.
float intersect_disc(int first, vec3 ray, out vec3 normal, out uint cell) {
  float t = 1e9;
  normal = vec3(0.0);
  cell = kNone;
  for (int dy = 0; dy <= 2 * kRadius; ++dy)
    for (int dx = 0; dx <= 2 * kRadius; ++dx) {
      Kernel k = kernel_at(first, dx, dy, ray);
      float slope = dot(k.normal, ray);
      if (k.inverse_radius >= kNoKernel || slope <= 0.1) continue;
      float candidate = dot(k.normal, k.position) / slope;
      vec3 v = candidate * ray - k.position;
      // The support of a kernel spans 2.5 pixel diagonals, a splat one.
      if (candidate < t && dot(v, v) * (k.inverse_radius * k.inverse_radius) < 0.16) {
        t = candidate;
        normal = k.normal;
        cell = uint(dx | (dy << 8));
      }
    }
  return t < 1e9 ? t : 0.0;
}

// `cell` counts from the window's corner of `pixel`.
void write(ivec2 pixel, float z, vec3 normal, uint cell) {
  uint index = uint(pixel.y) * p.camera.width + uint(pixel.x);
  if (z <= 0.0 || cell == kNone) {
    points[index] = kNoPoint;
    intensity[index] = -1.0;
    return;
  }
  ivec2 source = pixel + ivec2(int(cell & 255u), int(cell >> 8)) - kRadius;
  uint slot = uvec2_at(nearest, uint(source.y) * p.camera.width + uint(source.x)).x;
  SurfelAttributes a = attributes_at(attributes, slot);
  float weight =
      tracking_weight(unpackHalf2x16(a.curvatures), vec4_at(position_confidence, slot).w * p.confidence_scale, p.curvature_lambda_per_m, z);
  points[index] = SurfacePoint(z, pack_normal(normal), a.curvatures, weight);
  intensity[index] = grey(surfel_color(a));
  atomicAdd(covered_count, 1u);
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.x * 4u, gl_GlobalInvocationID.y);
  if (!inside(p.camera, pixel)) return;
  int first = kernel_index(p.camera, pixel - kRadius);
  vec3 ray = pixel_ray(p.camera, vec2(pixel));
  vec4 z = vec4(0.0);
  Normals4 n = Normals4(vec4(0.0), vec4(0.0), vec4(0.0));
  uvec4 cells = uvec4(kNone);
  if (p.hrbf != 0u) {
    z = intersect_hrbf(first, Rays(ray.x + vec4(0.0, 1.0, 2.0, 3.0) / p.camera.fx, ray.y), n, cells);
  } else {
    for (int i = 0; i < 4; ++i) {
      vec3 normal;
      uint cell;
      z[i] = intersect_disc(first + i, ray + vec3(float(i) / p.camera.fx, 0.0, 0.0), normal, cell);
      n.x[i] = normal.x;
      n.y[i] = normal.y;
      n.z[i] = normal.z;
      cells[i] = cell == kNone ? kNone : cell + uint(i);
    }
  }
  for (int i = 0; i < 4; ++i) {
    ivec2 q = pixel + ivec2(i, 0);
    // The cells count from the first pixel's window.
    if (inside(p.camera, q)) write(q, z[i], vec3(n.x[i], n.y[i], n.z[i]), cells[i] == kNone ? kNone : cells[i] - uint(i));
  }
}
