#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
// Lists the pixels that become new surfels, zone by zone and in the order of tiles, so that the
// same measurement gets the same slot in every run. They are few: appending runs over the list
// alone, and this pass over words of bits.
#include "shaders/shared/map.h"
#include "shaders/lib/geometry.glsl"
#include "shaders/lib/parameters.glsl"
#include "shaders/lib/texels.glsl"
#include "shaders/lib/blocks.glsl"
layout(local_size_x = 64) in;
TEXELS(0, new_bits);  // by tile, one bit per pixel
TEXELS(1, new_by_group);
layout(scalar, binding = 2) writeonly buffer NewPixels { uint new_pixels[]; };
PARAMETERS(ListNewParams, p);

void main() {
  uint word = gl_GlobalInvocationID.x, tile = word / kNewWords, first = tile * kNewWords;
  if (tile >= p.tile_count) return;
  uint at = uint_at(new_by_group, tile);
  for (uint before = first; before < word; ++before) at += bitCount(uint_at(new_bits, before));
  for (uint bits = uint_at(new_bits, word); bits != 0u; bits &= bits - 1u) {
    uvec2 pixel = pixel_in_tile(p.camera, tile, 32u * (word - first) + findLSB(bits));
    new_pixels[at++] = pixel.y * p.camera.width + pixel.x;
  }
}
