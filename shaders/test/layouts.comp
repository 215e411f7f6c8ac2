// For the tests of core/gpu: push constants of every kind whose size is read from SPIR-V, and two
// views of one buffer.
#version 460
#extension GL_EXT_scalar_block_layout : require

layout(local_size_x = 4, local_size_y = 3, local_size_z = 2) in;

struct Inner {
  vec3 direction;   // 12
  float lengths[3]; // 12
};

layout(scalar, binding = 0) buffer Floats { float floats[]; };
layout(scalar, binding = 0) buffer Words { uint words[]; };
layout(scalar, binding = 1) buffer Target { float target[]; };

layout(scalar, push_constant) uniform Params {
  mat3 rotation;                // 36
  layout(row_major) mat2 flip;  // 16
  Inner inner[2];               // 48
  ivec2 size;                   //  8
  uint last;                    //  4: 112 in all
} params;

void main() {
  if (any(greaterThan(gl_GlobalInvocationID, uvec3(0)))) return;
  target[0] = (params.rotation * params.inner[1].direction).x;
  target[1] = (params.flip * vec2(params.inner[0].lengths[2], floats[0])).y;
  target[2] = float(params.size.y) + float(params.last) + float(words[1]);
}
