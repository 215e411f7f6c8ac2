// Reading and writing surfel attributes.
SurfelAttributes attributes_of(uvec4 words) {
  return SurfelAttributes(words.x, words.y, words.z, words.w);
}
#define attributes_at(attributes, slot) attributes_of(uvec4_at(attributes, slot))
float surfel_radius(SurfelAttributes a) { return unpackHalf2x16(a.radius_submap & 0xffffu).x; }
uint surfel_submap(SurfelAttributes a) { return a.radius_submap >> 16; }
const vec3 kColorSteps = vec3(8.0, 8.0, 4.0);  // steps per unit of 255
vec3 surfel_color(SurfelAttributes a) {
  return vec3(a.color & 2047u, (a.color >> 11) & 2047u, a.color >> 22) / kColorSteps;
}
// Rounds up where the fraction and `threshold`, below 1, add up to one: 0.5 rounds to the nearest,
// random numbers are unbiased.
uint pack_color(vec3 color, vec3 threshold) {
  uvec3 c = uvec3(clamp(color, 0.0, 255.0) * kColorSteps + threshold);
  return c.x | (c.y << 11) | (c.z << 22);
}
uint pack_radius_submap(float radius_m, uint submap) {
  return (packHalf2x16(vec2(radius_m, 0.0)) & 0xffffu) | (submap << 16);
}
float grey(vec3 color) { return dot(color, vec3(0.299, 0.587, 0.114)); }
