#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// The Hermite RBF implicit of the input frame in a 7x7 window (paper Eq. 2-5): moves each vertex along its ray onto the zero set,
// takes the normal from the gradient, principal curvatures from gradient and Hessian, and the confidence c = c_r c_d.
// Normals point away from the camera, so surfaces that bulge towards it have positive curvature.
#include "shaders/shared/frame.h"
#include "shaders/lib/geometry.glsl"
layout(local_size_x = 16, local_size_y = 16) in;
layout(scalar, binding = 0) readonly buffer Filtered { float filtered_m[]; };
layout(scalar, binding = 1) readonly buffer Normals { uint normals[]; };
layout(scalar, binding = 2) writeonly buffer Depth { float depth_m[]; };
layout(scalar, binding = 3) writeonly buffer SurfaceNormals { uint surface_normals[]; };
layout(scalar, binding = 4) writeonly buffer Curvatures { uint curvatures[]; };
layout(scalar, binding = 5) writeonly buffer Confidence { float confidence[]; };
layout(scalar, push_constant) uniform Push { SurfaceParams p; };

const int kRadius = 3;
const int kTile = 16 + 2 * kRadius;
const uint kMinKernels = 16;  // reference notes 1.6
// Two words a kernel: everything else follows from the pixel.
shared float tile_depth[kTile * kTile];
shared uint tile_normal[kTile * kTile];

struct Kernel {
  vec3 position, normal;
  float radius;  // 0: there is none
};

struct Field {
  vec3 gradient;
  vec3 hessian_diagonal;  // xx yy zz
  vec3 hessian_mixed;     // xy xz yz
  uint count;
};

void load_tile() {
  ivec2 corner = ivec2(gl_WorkGroupID.xy) * 16 - kRadius;
  for (uint i = gl_LocalInvocationIndex; i < kTile * kTile; i += 256u) {
    ivec2 pixel = corner + ivec2(i % kTile, i / kTile);
    bool visible = inside(p.camera, pixel);
    uint index = visible ? uint(pixel.y) * p.camera.width + uint(pixel.x) : 0u;
    uint normal = visible ? normals[index] : kNoNormal;
    tile_normal[i] = normal;
    tile_depth[i] = normal != kNoNormal ? filtered_m[index] : 0.0;
  }
}

Kernel kernel_at(ivec2 local, int dx, int dy, vec3 ray) {
  int i = (local.y + dy) * kTile + local.x + dx;
  float z = tile_depth[i];
  vec3 normal = unpack_normal(tile_normal[i]);
  vec3 position = z * (ray + vec3(float(dx) / p.camera.fx, float(dy) / p.camera.fy, 0.0));
  return Kernel(position, normal, support_radius(p.camera, p.radius_scale, z, normal.z));
}

// One weighted-plane step along the ray (reference notes 8.2.1): t = sum(w n.p) / sum(w n.d), w = s^3 / r^2.
float step_to_surface(ivec2 local, vec3 ray, float t, float centre_z) {
  vec3 x = t * ray;
  float numerator = 0.0, denominator = 0.0;
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      Kernel k = kernel_at(local, dx, dy, ray);
      vec3 v = x - k.position;
      float inverse_radius = 1.0 / max(k.radius, 1e-6);
      float s = max(1.0 - sqrt(dot(v, v)) * inverse_radius, 0.0);
      float w = abs(k.position.z - centre_z) < p.depth_gate_m ? s * s * s * inverse_radius * inverse_radius : 0.0;
      numerator += w * dot(k.normal, k.position);
      denominator += w * dot(k.normal, ray);
    }
  }
  return abs(denominator) > 0.0 ? numerator / denominator : t;
}

Field evaluate(ivec2 local, vec3 ray, float t, float centre_z) {
  vec3 x = t * ray;
  Field f = Field(vec3(0.0), vec3(0.0), vec3(0.0), 0u);
  for (int dy = -kRadius; dy <= kRadius; ++dy) {
    for (int dx = -kRadius; dx <= kRadius; ++dx) {
      Kernel k = kernel_at(local, dx, dy, ray);
      vec3 n = k.normal;
      vec3 v = x - k.position;
      float inverse_radius = 1.0 / max(k.radius, 1e-6);
      float weight = inverse_radius * inverse_radius;
      float rho = sqrt(dot(v, v)) * inverse_radius;
      bool supports = rho < 1.0 && abs(k.position.z - centre_z) < p.depth_gate_m && k.radius > 0.0;
      f.count += supports ? 1u : 0u;
      float a = supports ? 200.0 * weight : 0.0;  // 20 C / r^2 with C = 10
      float s = 1.0 - rho;
      float u = dot(n, v);
      // The second derivative jumps at the kernel's own centre: there its terms are left out (reference notes 1.5).
      bool own = dx == 0 && dy == 0;
      float inverse_rho = 1.0 / max(rho, 1e-6);
      float q = s * s * inverse_rho;
      f.gradient += a * (s * s * s * n - 3.0 * weight * q * u * v);
      float h = own ? 0.0 : -3.0 * a * weight;
      float c = (inverse_rho * inverse_rho - 1.0) * inverse_rho * weight * u;
      f.hessian_diagonal += h * (q * (2.0 * n * v + u) - c * v * v);
      f.hessian_mixed += h * (q * (n.xxy * v.yzz + v.xxy * n.yzz) - c * v.xxy * v.yzz);
    }
  }
  return f;
}

// Mean and Gaussian curvature of an implicit surface (paper Eq. 4), then kappa = H +- sqrt(H^2 - K).
vec2 principal_curvatures(Field f) {
  vec3 g = f.gradient;
  float g2 = dot(g, g);
  vec3 d = f.hessian_diagonal, m = f.hessian_mixed;
  vec3 hg = vec3(d.x * g.x + m.x * g.y + m.y * g.z, m.x * g.x + d.y * g.y + m.z * g.z, m.y * g.x + m.z * g.y + d.z * g.z);
  float mean = (dot(g, hg) - g2 * (d.x + d.y + d.z)) / (2.0 * g2 * sqrt(g2));
  // g^T adj(Hessian) g
  vec3 cofactor_diagonal = vec3(d.y * d.z - m.z * m.z, d.x * d.z - m.y * m.y, d.x * d.y - m.x * m.x);
  vec3 cofactor_mixed = vec3(m.y * m.z - m.x * d.z, m.x * m.z - m.y * d.y, m.x * m.y - m.z * d.x);
  float gaussian = (dot(cofactor_diagonal, g * g) + 2.0 * dot(cofactor_mixed, g.xxy * g.yzz)) / (g2 * g2);
  float root = sqrt(max(0.0, mean * mean - gaussian));
  return vec2(mean + root, mean - root);
}

void main() {
  load_tile();
  barrier();
  ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (!inside(p.camera, pixel)) return;
  ivec2 local = ivec2(gl_LocalInvocationID.xy) + kRadius;
  uint index = uint(pixel.y) * p.camera.width + uint(pixel.x);
  vec3 ray = pixel_ray(p.camera, vec2(pixel));
  Kernel own = kernel_at(local, 0, 0, ray);
  float z = own.position.z;
  if (z > 0.0 && p.project_to_surface != 0u) {
    float moved = step_to_surface(local, ray, z, z);
    if (abs(moved - z) < 0.5 * own.radius) z = moved;
  }
  Field f = evaluate(local, ray, z, own.position.z);
  float gradient2 = dot(f.gradient, f.gradient);
  vec2 kappa = principal_curvatures(f);
  bool valid = z > 0.0 && f.count >= kMinKernels && gradient2 > 0.0 && f.gradient.z > 0.0 && abs(kappa.x) < p.curvature_limit_per_m &&
               abs(kappa.y) < p.curvature_limit_per_m;
  vec2 half_size = 0.5 * vec2(p.camera.width, p.camera.height);
  vec2 offset = vec2(pixel) - vec2(p.camera.cx, p.camera.cy);
  float c_d = exp(-dot(offset, offset) / dot(half_size, half_size) / 0.72);  // 2 sigma^2, sigma = 0.6 (Keller et al. 2013)
  float c_r = p.use_hrbf_confidence != 0u ? exp(-p.confidence_epsilon * inversesqrt(max(abs(dot(f.gradient, own.normal)), 1e-6))) : 1.0;
  depth_m[index] = valid ? z : 0.0;
  surface_normals[index] = valid ? pack_normal(f.gradient * inversesqrt(gradient2)) : kNoNormal;
  curvatures[index] = valid ? packHalf2x16(kappa) : 0u;
  confidence[index] = valid ? c_d * c_r : 0.0;
}
