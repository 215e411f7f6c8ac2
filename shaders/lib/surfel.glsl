// Reading and writing surfel attributes.
SurfelAttributes attributes_of(uvec4 words) { return SurfelAttributes(words.x, words.y, words.z, words.w); }
#define attributes_at(attributes, slot) attributes_of(uvec4_at(attributes, slot))
float surfel_radius(SurfelAttributes a) { return unpackHalf2x16(a.radius_submap & 0xffffu).x; }
uint surfel_submap(SurfelAttributes a) { return a.radius_submap >> 16; }
vec3 surfel_color(SurfelAttributes a) { return vec3(a.color & 255u, (a.color >> 8) & 255u, (a.color >> 16) & 255u); }
uint pack_color(vec3 color) {
  uvec3 c = uvec3(clamp(color, 0.0, 255.0) + 0.5);
  return c.x | (c.y << 8) | (c.z << 16);
}
uint pack_radius_submap(float radius_m, uint submap) { return (packHalf2x16(vec2(radius_m, 0.0)) & 0xffffu) | (submap << 16); }
float grey(vec3 color) { return dot(color, vec3(0.299, 0.587, 0.114)); }
