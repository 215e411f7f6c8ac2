// For the tests of core/gpu: target[i] = factor * source[i] + offset + kBias over a 3-D grid; local
// size and bias are specialised.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 8, local_size_x_id = 0, local_size_y = 2, local_size_z = 1) in;
layout(constant_id = 1) const uint kBias = 0;

layout(scalar, set = 0, binding = 0) readonly buffer Source { uint source[]; };
layout(scalar, set = 0, binding = 1) buffer Target { uint target[]; };

layout(scalar, push_constant) uniform Params {
  uvec3 size;
  uint factor;
  uint offset;
} params;

void main() {
  const uvec3 at = gl_GlobalInvocationID;
  if (any(greaterThanEqual(at, params.size))) return;
  const uint i = (at.z * params.size.y + at.y) * params.size.x + at.x;
  target[i] = params.factor * source[i] + params.offset + kBias;
}
