#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Pixels that won the association update their surfel in place, by means weighted by confidence
// (paper Eq. 11) and resolution. New measurements are listed and counted per workgroup.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/surfel.glsl"
#include "shaders/lib/fuse_bindings.glsl"
layout(local_size_x = 256) in;
TEXELS(10, cells);  // IndexCell
TEXELS(11, claims);
layout(scalar, binding = 12) writeonly buffer Changed { uint changed_frame[]; };
// A surfel is processed by one thread, which reads it before it writes.
TEXELS(13, read_position_confidence);
TEXELS(14, read_attributes);
// By tile, one bit per pixel.
layout(scalar, binding = 15) writeonly buffer NewBits { uint new_bits[]; };
shared uint bits_of_tile[kNewWords];

// Returns three pseudorandom numbers in [0, 1), the same in every run: a hash of the surfel's
// position, independent of its slot, and of the frame.
vec3 drawn(vec3 position) {
  uvec3 bits = floatBitsToUint(position);
  uint h = (bits.x * 73856093u) ^ (bits.y * 19349663u) ^ (bits.z * 83492791u) ^
           (p.frame_number * 2654435769u);
  // The hash lowbias32 by Wellons.
  h = (h ^ (h >> 16)) * 0x7feb352du;
  h = (h ^ (h >> 15)) * 0x846ca68bu;
  h ^= h >> 16;
  return (vec3(h & 1023u, (h >> 10) & 1023u, (h >> 20) & 1023u) + 0.5) / 1024.0;
}

void merge(uint slot, Measurement m) {
  vec4 surfel = vec4_at(read_position_confidence, slot);
  SurfelAttributes a = attributes_at(read_attributes, slot);
  Transform t = transform_at(camera_from_submap, surfel_submap(a));
  float total = surfel.w + m.confidence;
  float radius = surfel_radius(a);
  // A much coarser measurement (farther away or more slanted) confirms the surfel but does not move
  // it.
  if (m.radius_m < 1.5 * radius) {
    // Filter and kernels round off corners by an amount that grows with the pixel's footprint, and
    // so with the radius: an error with a square in proportion to radius^2, the same from every
    // view at that distance. A mean weighted by confidence alone would keep it long after the
    // corner was seen from nearer.
    float coarser = p.weigh_by_radius != 0u ? m.radius_m / radius : 1.0;
    float gain = m.confidence / (surfel.w * coarser * coarser + m.confidence);
    vec3 normal = normalize(mix(unpack_unit(a.normal), rotate_back(t, m.normal), gain));
    // Moves the surfel only along its normal, because the measurement contains no information on
    // its position within the surface.
    surfel.xyz += gain * dot(normal, transform_back(t, m.position) - surfel.xyz) * normal;
    a.normal = pack_unit(normal);
    a.radius_submap = pack_radius_submap(mix(radius, m.radius_m, gain), surfel_submap(a));
    // The gain of one view is often less than half a quantisation step, so rounding to the nearest
    // would never change the colour; dithering does.
    vec3 color = surfel_color(a);
    float color_gain = p.color_use == 0u ? 0.0 : p.color_use == 1u ? gain : 1.0;
    a.color = pack_color(color + color_gain * (m.color - color),
                         drawn(surfel.xyz));
    a.curvatures = packHalf2x16(mix(unpackHalf2x16(a.curvatures), m.curvatures, gain));
    attributes[slot] = a;
  }
  // The cap of the confidence keeps old surfels able to move.
  surfel.w = min(total, max(surfel.w, p.max_confidence));
  position_confidence[slot] = surfel;
  times[slot].y = p.frame_number;
  changed_frame[slot / kBlock] = p.frame_number;
}

// Called by all threads.
void list(bool fresh) {
  uint lane = gl_LocalInvocationID.x;
  if (lane < kNewWords) bits_of_tile[lane] = 0u;
  barrier();
  if (fresh) atomicOr(bits_of_tile[lane / 32u], 1u << (lane % 32u));
  barrier();
  if (lane < kNewWords) new_bits[gl_WorkGroupID.x * kNewWords + lane] = bits_of_tile[lane];
  if (lane != 0u) return;
  uint count = 0u;
  for (uint word = 0u; word < kNewWords; ++word) count += bitCount(bits_of_tile[word]);
  new_by_group[gl_WorkGroupID.x] = count;
}

void main() {
  uint i = pixel_index();
  bool fresh = false;
  if (i != HERMITE_NONE) {
    uint cell = candidates[i];
    if (cell == kNew) {
      fresh = true;
    } else if (cell != HERMITE_NONE && (uint_at(claims, cell) & ((1u << kPixelBits) - 1u)) == i) {
      merge(uvec4_at(cells, cell).x, measure(i));
    }
  }
  list(fresh);
}
