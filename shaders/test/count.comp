// For the tests of core/gpu: every invocation counts itself, so that missing barriers and lost
// dispatches show.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 64) in;
layout(scalar, binding = 0) buffer Counts { uint counts[]; };

void main() {
  if (gl_GlobalInvocationID.x < counts.length()) counts[gl_GlobalInvocationID.x] += 1;
}
