// For hermite_bench: measures the peak rate of multiply-add instructions, with twelve independent
// chains.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 128) in;
layout(scalar, binding = 0) writeonly buffer Result { float result[]; };
layout(scalar, push_constant) uniform Params {
  uint rounds;  // of 16 multiply-adds per chain
  float scale, offset;
} params;

void main() {
  const float seed = float(gl_GlobalInvocationID.x);
  vec4 a = vec4(seed), b = vec4(seed + 1.0), c = vec4(seed + 2.0);
  for (uint round = 0; round < params.rounds; ++round) {
    for (int i = 0; i < 16; ++i) {
      a = a * params.scale + params.offset;
      b = b * params.scale + params.offset;
      c = c * params.scale + params.offset;
    }
  }
  const vec4 sum = a + b + c;
  result[gl_GlobalInvocationID.x] = sum.x + sum.y + sum.z + sum.w;
}
