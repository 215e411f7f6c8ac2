// Pixels of a surface as seen from one pose: one texel.
const SurfacePoint kNoPoint = SurfacePoint(0.0, kNoNormal, 0u, 0.0);
SurfacePoint point_of(uvec4 words) {
  return SurfacePoint(uintBitsToFloat(words.x), words.y, words.z, uintBitsToFloat(words.w));
}
#define point_at(points, i) point_of(uvec4_at(points, i))
