// For hermite_bench: measures how fast this device reads and writes memory that does not fit any
// cache.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 256) in;
layout(scalar, binding = 0) readonly buffer Source { uvec4 source[]; };
layout(scalar, binding = 1) writeonly buffer Target { uvec4 target[]; };
layout(scalar, push_constant) uniform Params { uint count; } params;

void main() {
  for (uint i = gl_GlobalInvocationID.x; i < params.count;
       i += gl_NumWorkGroups.x * gl_WorkGroupSize.x)
    target[i] = source[i];
}
