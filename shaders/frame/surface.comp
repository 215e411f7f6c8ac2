#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The Hermite RBF implicit of the input frame in a 7x7 window (paper Eq. 2-5): moves each vertex along its ray onto the zero set,
// takes the normal from the gradient, principal curvatures from gradient and Hessian, and the confidence c = c_r c_d.
// Normals point away from the camera, so surfaces that bulge towards it have positive curvature.
#include "shaders/shared/frame.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/kernels.glsl"
#include "shaders/lib/surface_point.glsl"
layout(local_size_x = 8, local_size_y = 16) in;  // four neighbouring pixels an invocation: a kernel is unpacked once for all of them
TEXELS(0, kernels);
layout(scalar, binding = 1) writeonly buffer Points { SurfacePoint points[]; };
PARAMETERS(SurfaceParams, p);

const int kRadius = 3;
const uint kMinKernels = 16;  // of 49, as the authors' program has it

struct Kernel {
  vec3 position, normal;
  float inverse_radius;  // kNoKernel: there is none
};
vec2 inverse_focal = 1.0 / vec2(p.camera.fx, p.camera.fy);

// Of four points, one a component.
struct Field {
  vec4 gradient_x, gradient_y, gradient_z;
  vec4 xx, yy, zz, xy, xz, yz;  // Hessian
  vec4 count;                   // kernels that contribute
};

// Rays of the four pixels, (x, y, 1), and the depths of their vertices.
struct Rays {
  vec4 x;
  float y;
  vec4 vertex_z;
};

// `first` is the index of the window's corner for the first pixel, `ray` belongs to its centre.
Kernel kernel_at(int first, int dx, int dy, vec3 ray) {
  uvec4 words = uvec4_at(kernels, uint(first + dy * kernel_stride(p.camera) + dx));
  vec3 position = uintBitsToFloat(words.x) * (ray + vec3(vec2(dx - kRadius, dy - kRadius) * inverse_focal, 0.0));
  return Kernel(position, vec3(unpack_snorm(words.y), uintBitsToFloat(words.z)), inverse_radius_of(words.w));
}

// 1 where column dx of the first pixel's window is in the window of each pixel and the kernel lies on the same surface as its vertex.
vec4 admits(int dx, Kernel k, Rays rays) {
  vec4 column = float(dx) - vec4(0.0, 1.0, 2.0, 3.0);
  vec4 near = vec4(lessThan(abs(k.position.z - rays.vertex_z), vec4(p.depth_gate_m)));
  return step(0.0, column) * step(column, vec4(2.0 * kRadius)) * near * (k.inverse_radius < kNoKernel ? 1.0 : 0.0);
}

// One weighted-plane step along the rays (core/METHOD.md, "Step along the ray"): t = sum(w n.p) / sum(w n.d), w = s^3 / r^2.
vec4 step_to_surface(int first, Rays rays) {
  vec4 t = rays.vertex_z, x = t * rays.x, y = t * rays.y;
  vec4 plane = vec4(0.0), slope = vec4(0.0);
  vec3 ray = vec3(rays.x.x, rays.y, 1.0);
  for (int dy = 0; dy <= 2 * kRadius; ++dy) {
    for (int dx = 0; dx <= 2 * kRadius + 3; ++dx) {
      Kernel k = kernel_at(first, dx, dy, ray);
      vec4 vx = x - k.position.x, vy = y - k.position.y, vz = t - k.position.z;
      vec4 s = max(1.0 - sqrt(vx * vx + vy * vy + vz * vz) * k.inverse_radius, 0.0);
      vec4 w = s * s * s * (k.inverse_radius * k.inverse_radius) * admits(dx, k, rays);
      plane += w * dot(k.normal, k.position);
      slope += w * (k.normal.x * rays.x + (k.normal.y * rays.y + k.normal.z));
    }
  }
  return mix(t, plane / slope, greaterThan(slope, vec4(0.0)));
}

Field evaluate(int first, Rays rays, vec4 t) {
  const vec4 kZero = vec4(0.0);
  Field f = Field(kZero, kZero, kZero, kZero, kZero, kZero, kZero, kZero, kZero, kZero);
  vec4 x = t * rays.x, y = t * rays.y;
  vec3 ray = vec3(rays.x.x, rays.y, 1.0);
  for (int dy = 0; dy <= 2 * kRadius; ++dy) {
    for (int dx = 0; dx <= 2 * kRadius + 3; ++dx) {
      Kernel k = kernel_at(first, dx, dy, ray);
      vec3 n = k.normal;
      vec4 vx = x - k.position.x, vy = y - k.position.y, vz = t - k.position.z;
      float weight = k.inverse_radius * k.inverse_radius;
      vec4 rho = sqrt(vx * vx + vy * vy + vz * vz) * k.inverse_radius;
      vec4 supports = admits(dx, k, rays) * vec4(lessThan(rho, vec4(1.0)));
      f.count += supports;
      vec4 a = supports * (200.0 * weight);  // 20 C / r^2 with C = 10
      vec4 s = 1.0 - rho;
      vec4 u = n.x * vx + n.y * vy + n.z * vz;
      vec4 inverse_rho = 1.0 / max(rho, 1e-6);
      vec4 q = s * s * inverse_rho;
      vec4 toward_normal = a * s * s * s, along = a * (3.0 * weight) * q * u;
      f.gradient_x += toward_normal * n.x - along * vx;
      f.gradient_y += toward_normal * n.y - along * vy;
      f.gradient_z += toward_normal * n.z - along * vz;
      // The second derivative jumps at the kernel's own centre: there its terms are left out (core/METHOD.md).
      vec4 other = vec4(notEqual(ivec4(dx), kRadius + ivec4(0, 1, 2, 3))) + (dy != kRadius ? 1.0 : 0.0);
      vec4 h = a * (-3.0 * weight) * min(other, 1.0);
      vec4 c = (inverse_rho * inverse_rho - 1.0) * inverse_rho * weight * u;
      f.xx += h * (q * (2.0 * n.x * vx + u) - c * vx * vx);
      f.yy += h * (q * (2.0 * n.y * vy + u) - c * vy * vy);
      f.zz += h * (q * (2.0 * n.z * vz + u) - c * vz * vz);
      f.xy += h * (q * (n.x * vy + n.y * vx) - c * vx * vy);
      f.xz += h * (q * (n.x * vz + n.z * vx) - c * vx * vz);
      f.yz += h * (q * (n.y * vz + n.z * vy) - c * vy * vz);
    }
  }
  return f;
}

// Mean and Gaussian curvature of an implicit surface (paper Eq. 4), then kappa = H +- sqrt(H^2 - K). g, d and m: gradient, diagonal
// (xx yy zz) and mixed (xy xz yz) second derivatives.
vec2 principal_curvatures(vec3 g, vec3 d, vec3 m) {
  float g2 = max(dot(g, g), 1e-30);
  vec3 hg = vec3(d.x * g.x + m.x * g.y + m.y * g.z, m.x * g.x + d.y * g.y + m.z * g.z, m.y * g.x + m.z * g.y + d.z * g.z);
  float mean = (dot(g, hg) - g2 * (d.x + d.y + d.z)) / (2.0 * g2 * sqrt(g2));
  // g^T adj(Hessian) g
  vec3 cofactor_diagonal = vec3(d.y * d.z - m.z * m.z, d.x * d.z - m.y * m.y, d.x * d.y - m.x * m.x);
  vec3 cofactor_mixed = vec3(m.y * m.z - m.x * d.z, m.x * m.z - m.y * d.y, m.x * m.y - m.z * d.x);
  float gaussian = (dot(cofactor_diagonal, g * g) + 2.0 * dot(cofactor_mixed, g.xxy * g.yzz)) / (g2 * g2);
  float root = sqrt(max(0.0, mean * mean - gaussian));
  return vec2(mean + root, mean - root);
}

float confidence_at(ivec2 pixel, float gradient) {
  vec2 half_size = 0.5 * vec2(p.camera.width, p.camera.height);
  vec2 offset = vec2(pixel) - vec2(p.camera.cx, p.camera.cy);
  float c_d = exp(-dot(offset, offset) / dot(half_size, half_size) / 0.72);  // 2 sigma^2, sigma = 0.6 (Keller et al. 2013)
  return p.use_hrbf_confidence != 0u ? c_d * exp(-p.confidence_epsilon * inversesqrt(max(gradient, 1e-6))) : c_d;
}

void write(ivec2 pixel, float z, vec3 gradient, vec3 diagonal, vec3 mixed, float count, vec3 first_normal) {
  uint index = uint(pixel.y) * p.camera.width + uint(pixel.x);
  vec2 kappa = principal_curvatures(gradient, diagonal, mixed);
  bool facing = gradient.z > 0.0 && dot(gradient, pixel_ray(p.camera, vec2(pixel))) > 0.0;  // nobody sees a back side
  bool valid = z > 0.0 && count >= float(kMinKernels) && facing && abs(kappa.x) < p.curvature_limit_per_m &&
               abs(kappa.y) < p.curvature_limit_per_m;
  float confidence = confidence_at(pixel, abs(dot(gradient, first_normal)));
  points[index] = valid ? SurfacePoint(z, pack_normal(normalize(gradient)), packHalf2x16(kappa), confidence) : kNoPoint;
}

void main() {
  ivec2 pixel = ivec2(gl_GlobalInvocationID.x * 4u, gl_GlobalInvocationID.y);
  if (!inside(p.camera, pixel)) return;
  int first = kernel_index(p.camera, pixel - kRadius);
  uint centre = uint(kernel_index(p.camera, pixel));
  vec3 ray = pixel_ray(p.camera, vec2(pixel));
  Rays rays = Rays(ray.x + vec4(0.0, 1.0, 2.0, 3.0) / p.camera.fx, ray.y,
                   vec4(vec4_at(kernels, centre).x, vec4_at(kernels, centre + 1u).x, vec4_at(kernels, centre + 2u).x, vec4_at(kernels, centre + 3u).x));
  vec4 z = rays.vertex_z;
  if (p.project_to_surface != 0u) {
    vec4 moved = step_to_surface(first, rays);
    // Half a frontal support radius: farther is another surface.
    vec4 limit = 0.5 * p.radius_scale * 2.8284271 / (p.camera.fx + p.camera.fy) * z;
    z = mix(z, moved, lessThan(abs(moved - z), limit));
  }
  Field f = evaluate(first, rays, z);
  for (int i = 0; i < 4; ++i) {
    ivec2 q = pixel + ivec2(i, 0);
    if (!inside(p.camera, q)) continue;
    write(q, z[i], vec3(f.gradient_x[i], f.gradient_y[i], f.gradient_z[i]), vec3(f.xx[i], f.yy[i], f.zz[i]),
          vec3(f.xy[i], f.xz[i], f.yz[i]), f.count[i], unpack_normal(uvec4_at(kernels, centre + uint(i)).y));
  }
}
