// For the tests of core/gpu: runs as long as requested, to test time-outs.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 1) in;
layout(scalar, binding = 0) buffer Result { uint result[]; };
layout(scalar, push_constant) uniform Params { uint rounds; } params;

void main() {
  uint state = result[0];
  for (uint round = 0; round < params.rounds; ++round)
    for (uint i = 0; i < 10000; ++i) state = state * 1664525u + 1013904223u + result[state & 1u];
  result[0] = state;
}
