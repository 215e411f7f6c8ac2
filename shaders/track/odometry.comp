#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Normal equations of one Gauss-Newton step: weighted point-to-plane terms against the predicted
// surface (paper Eq. 6-9) plus photometric terms against its colour (Eq. 10), linearised for
// reference_from_camera <- exp(x) reference_from_camera, x = (translation, rotation). The two
// systems are separate: the host judges the geometric one before it adds them
// (core/track/normal_equations.h). Exposure is unknown, so the photometric system has a gain and an
// offset of the frame in addition to the motion. Residuals of both kinds are assumed to follow
// Student's t distribution, whose scale the host estimates from step to step (Kerl, Sturm, Cremers
// 2013, Robust odometry estimation for RGB-D cameras), so that moving objects and reflections have
// little weight.
#include "shaders/shared/track.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surface_point.glsl"
const uint kTerms = kOdometrySumCount;
const uint kGroupSize = HERMITE_ODOMETRY_GROUP_SIZE;
layout(local_size_x = HERMITE_ODOMETRY_GROUP_SIZE) in;
// 0: projective association. A constant, since software devices execute a skipped branch under a
// mask.
layout(constant_id = 0) const int kSearchRadius = 0;
TEXELS(0, points);
TEXELS(1, image);  // GreyAndGradient
TEXELS(2, reference_points);
TEXELS(3, reference_intensity);
layout(scalar, binding = 4) writeonly buffer Sums { float partial_sums[]; };
TEXELS(5, residual_model);
PARAMETERS(OdometryParams, p);
ResidualModel model_from(vec4 first, vec4 second) {
  return ResidualModel(first.x, first.y, first.z, first.w, second.x, second.y, second.z, second.w);
}
ResidualModel m = model_from(vec4_at(residual_model, 0u), vec4_at(residual_model, 1u));
#include "shaders/lib/sums.glsl"

const float kSaturated = 250.0;  // brighter grey values are saturated
// Blur and misalignment of map and frame, 0.3 pixels, divided by the spread of grey values, 4.
const float kBlur = 0.075;

// Blocks of normal equations H x = b in named registers, since indexed arrays would be in memory.
struct System {
  mat3 tt, tr, rr;  // tr: column r, row t
  vec3 t, r;
};
const System kEmpty = System(mat3(0.0), mat3(0.0), mat3(0.0), vec3(0.0), vec3(0.0));
System geometric = kEmpty, photometric = kEmpty;
// Weighted moments of the geometric pairs, from which follows how far a motion moves their points.
float moment_0 = 0.0;
vec3 moment_1 = vec3(0.0);
mat3 moment_2 = mat3(0.0);
float disagreement = 0.0;  // squared sine between the normals, weighted
// Of all pairs near each other: the same, with 1 beyond 90 degrees; weight.
vec2 near_disagreement = vec2(0.0);
vec2 geometric_error = vec2(0.0), photometric_error = vec2(0.0);  // squared error, count
float surface_count = 0.0;
// Weighted products of the photometric pairs: (1, grey) of the reference with the motion, with
// itself, and with the residual.
vec3 gain_t = vec3(0.0), gain_r = vec3(0.0), offset_t = vec3(0.0), offset_r = vec3(0.0);
vec3 brightness = vec3(0.0);  // grey^2, grey, 1
vec2 brightness_residual = vec2(0.0);
// Weight, weight * robust * residual^2.
vec2 geometric_spread = vec2(0.0), photometric_spread = vec2(0.0);
vec2 gradients = vec2(0.0);

// Returns the weight of a residual in scales, 1 at zero.
const float kDegreesOfFreedom = 5.0;
float robust(float residual) {
  return kDegreesOfFreedom / (kDegreesOfFreedom + residual * residual);
}

float noise_m(float z) {
  float beyond = max(z - 0.4, 0.0);
  return m.noise_floor_m + m.noise_growth_per_m * beyond * beyond;
}

void add_row(inout System system, vec3 translation, vec3 rotation, float residual, float weight) {
  vec3 t = weight * translation, r = weight * rotation;
  system.tt += outerProduct(translation, t);
  system.tr += outerProduct(translation, r);
  system.rr += outerProduct(rotation, r);
  system.t -= residual * t;
  system.r -= residual * r;
}

void put_upper_triangle(mat3 m) {
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j) put_term(m[j][i]);
}

void put_vector(vec3 v) {
  for (int i = 0; i < 3; ++i) put_term(v[i]);
}

void put_pair(vec2 v) {
  put_term(v.x);
  put_term(v.y);
}

void put_system(System system) {
  for (int i = 0; i < 3; ++i) {
    for (int j = i; j < 3; ++j) put_term(system.tt[j][i]);
    for (int j = 0; j < 3; ++j) put_term(system.tr[j][i]);
  }
  put_upper_triangle(system.rr);
  put_vector(system.t);
  put_vector(system.r);
}

vec3 reference_vertex(ivec2 pixel, SurfacePoint point) {
  return pixel_ray(p.reference, vec2(pixel)) * point.depth_m;
}

bool agree(vec3 point, vec3 normal, vec3 vertex, vec3 n) {
  vec3 v = point - vertex, c = cross(n, normal);
  return vertex.z > 0.0 && dot(v, v) < p.distance_gate_m * p.distance_gate_m &&
         dot(n, normal) > 0.0 && dot(c, c) < p.sine_normal_gate * p.sine_normal_gate;
}

// Returns the least dissimilar point of the prediction in a window around the projection (paper Eq.
// 6, 7). R_max is the farthest one that agrees.
uint search(ivec2 centre, vec3 point, vec3 normal, vec2 kappa) {
  const int radius = kSearchRadius;
  float farthest = 1e-9;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      ivec2 q = centre + ivec2(dx, dy);
      if (!inside(p.reference, q)) continue;
      uint i = uint(q.y) * p.reference.width + uint(q.x);
      float d = distance(point, reference_vertex(q, point_at(reference_points, i)));
      if (d < p.distance_gate_m) farthest = max(farthest, d);
    }
  float best = 1e9;
  uint found = HERMITE_NONE;
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx) {
      ivec2 q = centre + ivec2(dx, dy);
      if (!inside(p.reference, q)) continue;
      uint i = uint(q.y) * p.reference.width + uint(q.x);
      SurfacePoint candidate = point_at(reference_points, i);
      vec3 vertex = reference_vertex(q, candidate);
      vec3 n = unpack_normal(candidate.normal);
      if (!agree(point, normal, vertex, n)) continue;
      vec2 k = unpackHalf2x16(candidate.curvatures);
      float scale = max(max(abs(k.x), abs(k.y)), 1e-3);
      float dissimilarity = distance(point, vertex) / farthest + 1.0 - dot(n, normal) + 1.0 -
                            exp(-(abs(kappa.x - k.x) + abs(kappa.y - k.y)) / scale);
      if (dissimilarity < best) {
        best = dissimilarity;
        found = i;
      }
    }
  return found;
}

// `shown` is the prediction at the pixel `centre` onto which s, seen as `point`, projects. Returns
// whether both are the same surface.
bool add_geometry(ivec2 centre, SurfacePoint shown, vec3 s, SurfacePoint point) {
  vec3 normal = rotate(p.reference_from_camera, unpack_normal(point.normal));
  if (kSearchRadius > 0) {
    uint j = search(centre, s, normal, unpackHalf2x16(point.curvatures));
    if (j == HERMITE_NONE) return false;
    shown = point_at(reference_points, j);
    centre = ivec2(j % p.reference.width, j / p.reference.width);
  }
  vec3 d = reference_vertex(centre, shown), n = unpack_normal(shown.normal);
  // Pairs that pass the gate of angles have similar normals by selection, whatever their noise.
  vec3 apart = s - d, sine = cross(n, normal);
  if (d.z > 0.0 && dot(apart, apart) < p.distance_gate_m * p.distance_gate_m)
    near_disagreement += shown.weight * vec2(dot(n, normal) > 0.0 ? dot(sine, sine) : 1.0, 1.0);
  if (!agree(s, normal, d, n)) return false;
  float residual = dot(n, s - d), scaled = residual / noise_m(point.depth_m);
  float base = p.geometric_weight * shown.weight, likely = robust(scaled / m.geometric_scale);
  float weight = base * likely;
  add_row(geometric, n, cross(s, n), residual, weight);
  moment_0 += weight;
  moment_1 += weight * s;
  moment_2 += outerProduct(s, weight * s);
  disagreement += weight * dot(sine, sine);
  geometric_error += vec2(residual * residual, 1.0);
  geometric_spread += vec2(base, weight * scaled * scaled);
  return abs(scaled) < m.photometric_gate * m.geometric_scale;
}

void add_photometry(vec2 uv, SurfacePoint shown, vec3 s, uint i) {
  uvec2 seen = uvec2_at(image, i);
  vec2 g = unpackHalf2x16(seen.y);
  float grey = uintBitsToFloat(seen.x);
  if (dot(g, g) < p.gradient_min * p.gradient_min || grey > kSaturated) return;
  ivec2 q = ivec2(floor(uv));
  if (q.x < 0 || q.y < 0 || q.x + 1 >= int(p.reference.width) || q.y + 1 >= int(p.reference.height))
    return;
  uint j = uint(q.y) * p.reference.width + uint(q.x);
  float i00 = float_at(reference_intensity, j), i10 = float_at(reference_intensity, j + 1u);
  float i01 = float_at(reference_intensity, j + p.reference.width),
        i11 = float_at(reference_intensity, j + p.reference.width + 1u);
  if (min(min(i00, i10), min(i01, i11)) < 0.0) return;
  vec2 f = uv - vec2(q);
  if (abs(shown.depth_m - s.z) > p.photometric_depth_gate_m) return;
  float known = mix(mix(i00, i10, f.x), mix(i01, i11, f.x), f.y);
  float residual = grey - (m.gain * known + m.offset);
  vec2 scaled = g * vec2(p.camera.fx, p.camera.fy) / s.z;
  vec3 a = -vec3(scaled, -dot(scaled, s.xy) / s.z), r = cross(s, a);
  // Gradients of noise would suggest that the camera stands still. But the map has other noise, so
  // gradients that both show are real.
  vec2 shown_g = m.gain * vec2(mix(i10 - i00, i11 - i01, f.y), mix(i01 - i00, i11 - i10, f.x));
  gradients += vec2(dot(g, shown_g), dot(g, g));
  // A surfel that was observed only a few times is uncertain in its colour as in its position.
  float maturity = min(1.0, shown.weight * shown.depth_m * shown.depth_m / m.mature_confidence);
  // Across an edge, a shift by a fraction of a pixel has more effect than the noise of grey values.
  float expected2 = 1.0 + dot(g, g) * (kBlur * kBlur), spread2 = residual * residual / expected2;
  float base = maturity / (p.photometric_sigma * p.photometric_sigma);
  float weight = base / expected2 * robust(sqrt(spread2) / m.photometric_scale);
  add_row(photometric, a, r, residual, weight);
  gain_t -= weight * known * a;
  gain_r -= weight * known * r;
  offset_t -= weight * a;
  offset_r -= weight * r;
  brightness += weight * vec3(known * known, known, 1.0);
  brightness_residual += weight * residual * vec2(known, 1.0);
  photometric_error += vec2(residual * residual, 1.0);
  photometric_spread += vec2(base, weight * residual * residual);
}

void main() {
  for (uint i = gl_GlobalInvocationID.x; i < p.camera.width * p.camera.height;
       i += gl_NumWorkGroups.x * kGroupSize) {
    ivec2 pixel = ivec2(i % p.camera.width, i / p.camera.width);
    SurfacePoint point = point_at(points, i);
    float z = point.depth_m;
    if (z <= 0.0 || point.weight <= 0.0) continue;  // masked: see frame/mask
    surface_count += 1.0;
    vec3 s = transform_point(p.reference_from_camera, pixel_ray(p.camera, vec2(pixel)) * z);
    if (s.z < 0.05) continue;
    vec2 uv = project(p.reference, s);
    ivec2 centre = ivec2(floor(uv + 0.5));
    if (!inside(p.reference, centre)) continue;
    uint j = uint(centre.y) * p.reference.width + uint(centre.x);
    SurfacePoint shown = point_at(reference_points, j);
    if (add_geometry(centre, shown, s, point)) add_photometry(uv, shown, s, i);
  }
  put_from(kGeometricSums);
  put_system(geometric);
  put_from(kPhotometricSums);
  put_system(photometric);
  put_from(kMomentSums);
  put_term(moment_0);
  put_vector(moment_1);
  put_upper_triangle(moment_2);
  put_at(kDisagreementSum, disagreement);
  put_from(kNearSums);
  put_pair(near_disagreement);
  put_from(kGeometricErrorSums);
  put_pair(geometric_error);
  put_from(kPhotometricErrorSums);
  put_pair(photometric_error);
  put_at(kSurfaceCountSum, surface_count);
  put_from(kMixedSums);
  for (int i = 0; i < 3; ++i) put_pair(vec2(gain_t[i], offset_t[i]));
  for (int i = 0; i < 3; ++i) put_pair(vec2(gain_r[i], offset_r[i]));
  put_from(kBrightnessSums);
  put_vector(brightness);
  put_pair(brightness_residual);
  put_from(kGeometricSpreadSums);
  put_pair(geometric_spread);
  put_from(kPhotometricSpreadSums);
  put_pair(photometric_spread);
  put_from(kGradientSums);
  put_pair(gradients);
  write_group_sums(p.first_group);
}
