// Weight of a point of the prediction in the odometry (Lefloch et al. 2017, as in the authors'
// program): features and well-confirmed points count more, far ones less. curvatures and lambda in
// 1/m, z in m, scaled_confidence in [0, 1].
float tracking_weight(vec2 curvatures, float scaled_confidence, float lambda, float z) {
  float largest = max(max(abs(curvatures.x), abs(curvatures.y)), 1e-3);
  return (scaled_confidence + exp(-lambda * lambda / (2.0 * largest * largest))) / (z * z);
}
