// Buffers that a pass only reads are bound as texel buffers: a texel is one element of up to four
// words (core/gpu/buffer.h). Software devices read a storage buffer word by word and lane by lane:
// four words cost them ten times as much as a texel.
//
// Every shader is compiled a second time with HERMITE_TEXELS_IN_STORAGE, for devices whose texel
// buffers are too small; then they are bound as storage buffers. The size of an element is not
// declared there, so a shader reads as many words as the element has through the function of that
// size.
#ifdef HERMITE_TEXELS_IN_STORAGE
#define TEXELS(number, name)                                                              \
  layout(scalar, binding = number) readonly buffer name##Ones { uint name##_ones[]; };    \
  layout(scalar, binding = number) readonly buffer name##Twos { uvec2 name##_twos[]; };   \
  layout(scalar, binding = number) readonly buffer name##Fours { uvec4 name##_fours[]; }; \
  layout(scalar, binding = number) readonly buffer name##Transforms {                     \
    Transform name##_transforms[];                                                        \
  }
#define uint_at(name, i) (name##_ones[i])
#define uvec2_at(name, i) (name##_twos[i])
#define uvec4_at(name, i) (name##_fours[i])
#define float_at(name, i) uintBitsToFloat(name##_ones[i])
#define vec4_at(name, i) uintBitsToFloat(name##_fours[i])
#define transform_at(name, i) (name##_transforms[i])
#else
#define TEXELS(number, name) layout(binding = number) uniform usamplerBuffer name

uint uint_at(usamplerBuffer buffer_, uint i) { return texelFetch(buffer_, int(i)).x; }
uvec2 uvec2_at(usamplerBuffer buffer_, uint i) { return texelFetch(buffer_, int(i)).xy; }
uvec4 uvec4_at(usamplerBuffer buffer_, uint i) { return texelFetch(buffer_, int(i)); }
float float_at(usamplerBuffer buffer_, uint i) {
  return uintBitsToFloat(texelFetch(buffer_, int(i)).x);
}
vec4 vec4_at(usamplerBuffer buffer_, uint i) {
  return uintBitsToFloat(texelFetch(buffer_, int(i)));
}
Transform transform_at(usamplerBuffer buffer_, uint i) {
  return Transform(vec4_at(buffer_, 3u * i), vec4_at(buffer_, 3u * i + 1u),
                   vec4_at(buffer_, 3u * i + 2u));
}
#endif
