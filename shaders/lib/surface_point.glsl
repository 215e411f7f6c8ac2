// Pixels of a surface as seen from one pose: one texel.
const SurfacePoint kNoPoint = SurfacePoint(0.0, kNoNormal, 0u, 0.0);
SurfacePoint point_at(usamplerBuffer points, uint i) {
  uvec4 words = texelFetch(points, int(i));
  return SurfacePoint(uintBitsToFloat(words.x), words.y, words.z, uintBitsToFloat(words.w));
}
