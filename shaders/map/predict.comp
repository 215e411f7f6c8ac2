#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The surface seen from a pose (paper section 3.1): each pixel's ray is met with the zero set of the Hermite RBF implicit of the surfels
// in a window of the index map. Weighted-plane iteration along the ray (reference notes 8.2.1) instead of a bisection.
// Attributes come from the kernel nearest to the solution. With hrbf == 0: the nearest surfel disc that the ray meets.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/surfel.glsl"
#include "shaders/lib/weight.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
layout(constant_id = 0) const int kRadius = 3;  // window of 2 kRadius + 1
layout(scalar, binding = 0) readonly buffer Positions { vec4 position_confidence[]; };
layout(scalar, binding = 1) readonly buffer Attributes { SurfelAttributes attributes[]; };
layout(scalar, binding = 2) readonly buffer Submaps { Transform camera_from_submap[]; };
layout(scalar, binding = 3) readonly buffer Ids { uint ids[]; };
layout(scalar, binding = 4) writeonly buffer Depth { float depth_m[]; };
layout(scalar, binding = 5) writeonly buffer Normals { uint normals[]; };
layout(scalar, binding = 6) writeonly buffer Curvatures { uint curvatures[]; };
layout(scalar, binding = 7) writeonly buffer Weight { float weight[]; };
layout(scalar, binding = 8) writeonly buffer Intensity { float intensity[]; };
layout(scalar, binding = 9) buffer Covered { uint covered_count; };
layout(scalar, push_constant) uniform Push { PredictParams p; };

const uint kNone = 0xffffffffu;
const int kTile = 16 + 2 * kRadius;
// Four words a kernel: loads are what this pass spends its time on.
shared float tile_depth[kTile * kTile];
shared uint tile_offset[kTile * kTile];  // from the pixel's centre, half pixels, 2 x snorm16
shared uint tile_normal[kTile * kTile];
shared float tile_radius[kTile * kTile];  // 0: there is no kernel

struct Kernel {
  vec3 position, normal;
  float radius;
};

void load_tile() {
  ivec2 corner = ivec2(gl_WorkGroupID.xy) * 16 - kRadius;
  for (uint i = gl_LocalInvocationIndex; i < kTile * kTile; i += 256u) {
    ivec2 pixel = corner + ivec2(i % kTile, i / kTile);
    uint slot = inside(p.camera, pixel) ? ids[uint(pixel.y) * p.camera.width + uint(pixel.x)] : kNone;
    float depth = 0.0, radius = 0.0;
    uint offset = 0u, packed_normal = 0u;
    if (slot != kNone) {
      SurfelAttributes a = attributes[slot];
      Transform t = camera_from_submap[surfel_submap(a)];
      vec3 n = rotate(t, unpack_unit(a.normal));
      vec4 surfel = position_confidence[slot];
      if (n.z >= 0.0 && surfel.w > 0.0) {
        vec3 position = transform_point(t, surfel.xyz);
        depth = position.z;
        offset = packSnorm2x16(2.0 * (project(p.camera, position) - vec2(pixel)));
        packed_normal = pack_normal(n);
        radius = surfel_radius(a);
      }
    }
    tile_depth[i] = depth;
    tile_offset[i] = offset;
    tile_normal[i] = packed_normal;
    tile_radius[i] = radius;
  }
}

// `first` is the window's corner in the tile, `ray` belongs to its centre.
Kernel kernel_at(int first, int dx, int dy, vec3 ray) {
  int i = first + dy * kTile + dx;
  vec2 offset = vec2(float(dx - kRadius), float(dy - kRadius)) + 0.5 * unpackSnorm2x16(tile_offset[i]);
  vec3 direction = ray + vec3(offset / vec2(p.camera.fx, p.camera.fy), 0.0);
  return Kernel(tile_depth[i] * direction, unpack_normal(tile_normal[i]), tile_radius[i]);
}

struct Sums {
  float plane, slope;  // sum w n.p and sum w n.d: the next t is their quotient
  vec3 gradient;       // proportional to the gradient of f
  uint support;
};

Sums evaluate(int first, vec3 ray, float t, vec3 mid_normal, float mix_normal) {
  vec3 x = t * ray;
  Sums sums = Sums(0.0, 0.0, vec3(0.0), 0u);
  for (int dy = 0; dy <= 2 * kRadius; ++dy) {
    for (int dx = 0; dx <= 2 * kRadius; ++dx) {
      Kernel k = kernel_at(first, dx, dy, ray);
      vec3 v = x - k.position;
      float inverse_radius = 1.0 / max(k.radius, 1e-6);
      float rho = sqrt(dot(v, v)) * inverse_radius;
      float s = max(1.0 - rho, 0.0);
      sums.support += s > 0.0 ? 1u : 0u;
      float s2 = s * s * inverse_radius * inverse_radius;
      vec3 m = mix(k.normal, mid_normal, mix_normal);
      sums.plane += s2 * s * dot(m, k.position);
      sums.slope += s2 * s * dot(m, ray);
      sums.gradient += s2 * (s * k.normal - (3.0 * inverse_radius * inverse_radius / max(rho, 1e-4)) * dot(k.normal, v) * v);
    }
  }
  return sums;
}

// Where the ray meets the zero set; 0 when it does not.
float intersect_hrbf(int first, vec3 ray, out vec3 normal) {
  normal = vec3(0.0);
  float ray2 = dot(ray, ray);
  float t = 1e9;
  for (int dy = 0; dy <= 2 * kRadius; ++dy)
    for (int dx = 0; dx <= 2 * kRadius; ++dx) {
      Kernel k = kernel_at(first, dx, dy, ray);
      if (k.radius > 0.0) t = min(t, dot(k.position, ray) / ray2);
    }
  if (t >= 1e9) return 0.0;
  Sums sums;
  bool converged = false;
  for (uint i = 0u; i < p.max_iterations && !converged; ++i) {
    sums = evaluate(first, ray, t, vec3(0.0), 0.0);
    if (abs(sums.slope) <= 0.0) return 0.0;
    float next = sums.plane / sums.slope;
    converged = abs(next - t) < 1e-5;
    t = next;
  }
  normal = normalize(sums.gradient);
  if (p.correct_bias != 0u) {
    // The zero set lies off a curved surface by about 0.075 H r^2; planes with the mean of both normals remove that (notes 8.2.4).
    Sums corrected = evaluate(first, ray, t, normal, 0.5);
    if (abs(corrected.slope) > 0.0) t = corrected.plane / corrected.slope;
  }
  return sums.support >= p.min_support && normal.z > 0.0 && !isnan(t) && t > 0.0 ? t : 0.0;
}

// The nearest disc that the ray meets, as Keller et al. 2013 splat them.
float intersect_disc(int first, vec3 ray, out vec3 normal) {
  float t = 1e9;
  normal = vec3(0.0);
  for (int dy = 0; dy <= 2 * kRadius; ++dy)
    for (int dx = 0; dx <= 2 * kRadius; ++dx) {
      Kernel k = kernel_at(first, dx, dy, ray);
      float slope = dot(k.normal, ray);
      if (k.radius <= 0.0 || slope <= 0.1) continue;
      float candidate = dot(k.normal, k.position) / slope;
      vec3 v = candidate * ray - k.position;
      // The support of a kernel spans four pixel diagonals, a splat a quarter of it.
      if (candidate < t && dot(v, v) < 0.0625 * k.radius * k.radius) {
        t = candidate;
        normal = k.normal;
      }
    }
  return t < 1e9 ? t : 0.0;
}

uint nearest_kernel(int first, vec3 ray, vec3 x) {
  float best = 1e9;
  uint cell = kNone;
  for (int dy = 0; dy <= 2 * kRadius; ++dy)
    for (int dx = 0; dx <= 2 * kRadius; ++dx) {
      Kernel k = kernel_at(first, dx, dy, ray);
      vec3 v = x - k.position;
      float d = dot(v, v);
      if (k.radius > 0.0 && d < best) {
        best = d;
        cell = uint(dy * 256 + dx);
      }
    }
  return cell;
}

void main() {
  load_tile();
  barrier();
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(p.camera, pixel)) return;
  int first = int(gl_LocalInvocationID.y) * kTile + int(gl_LocalInvocationID.x);
  uint index = uint(pixel.y) * p.camera.width + uint(pixel.x);
  vec3 ray = pixel_ray(p.camera, vec2(pixel));
  vec3 normal;
  float z = p.hrbf != 0u ? intersect_hrbf(first, ray, normal) : intersect_disc(first, ray, normal);
  uint cell = z > 0.0 ? nearest_kernel(first, ray, z * ray) : kNone;
  if (cell == kNone) {
    depth_m[index] = 0.0;
    normals[index] = kNoNormal;
    curvatures[index] = 0u;
    weight[index] = 0.0;
    intensity[index] = -1.0;
    return;
  }
  ivec2 source = pixel + ivec2(int(cell & 255u), int(cell >> 8)) - kRadius;
  uint slot = ids[uint(source.y) * p.camera.width + uint(source.x)];
  SurfelAttributes a = attributes[slot];
  vec2 kappa = unpackHalf2x16(a.curvatures);
  depth_m[index] = z;
  normals[index] = pack_normal(normal);
  curvatures[index] = a.curvatures;
  weight[index] = tracking_weight(kappa, position_confidence[slot].w * p.confidence_scale, p.curvature_lambda_per_m, z);
  intensity[index] = grey(surfel_color(a));
  atomicAdd(covered_count, 1u);
}
