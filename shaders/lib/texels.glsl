// Buffers that a pass only reads are bound as texel buffers: a texel is one element of up to four words (core/gpu/buffer.h). Of a storage
// buffer, software devices read word by word and lane by lane: four words cost them ten times as much as a texel does.
#define TEXELS(number, name) layout(binding = number) uniform usamplerBuffer name

uint uint_at(usamplerBuffer buffer_, uint i) { return texelFetch(buffer_, int(i)).x; }
uvec2 uvec2_at(usamplerBuffer buffer_, uint i) { return texelFetch(buffer_, int(i)).xy; }
uvec4 uvec4_at(usamplerBuffer buffer_, uint i) { return texelFetch(buffer_, int(i)); }
float float_at(usamplerBuffer buffer_, uint i) { return uintBitsToFloat(texelFetch(buffer_, int(i)).x); }
vec4 vec4_at(usamplerBuffer buffer_, uint i) { return uintBitsToFloat(texelFetch(buffer_, int(i))); }
Transform transform_at(usamplerBuffer buffer_, uint i) {
  return Transform(vec4_at(buffer_, 3u * i), vec4_at(buffer_, 3u * i + 1u), vec4_at(buffer_, 3u * i + 2u));
}
