#version 460
#extension GL_EXT_scalar_block_layout : require
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
// The index map in one pass, for devices with 64-bit atomics: index_depth and index_id together.
#include "shaders/lib/index_cell.glsl"
layout(scalar, binding = 3) buffer Nearest { uint64_t nearest[]; };  // NearestSurfel

void main() {
  uint slot = listed_slot(), cell, bits;
  if (index_cell(slot, cell, bits)) atomicMin(nearest[cell], (uint64_t(bits) << 32) | slot);
}
