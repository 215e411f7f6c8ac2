// Noise model of a keypoint's pixel and depth, and the chi-square bounds of outliers.
#pragma once

#include <cstddef>

namespace hermite::adjust {

// Returns the standard deviation [m] of a structured-light depth [m]: 0.00273 z^2 + 0.00074 z -
// 0.00058. This crosses zero at 0.345 m and would give near points unbounded weight, so it is
// clamped to at least a millimetre: the best that depth quantisation and the registration to colour
// allow.
double depth_deviation_m(double depth_m);

// The least error of dense tracking from one view to the next: a millimetre and a twentieth of a
// degree.
inline constexpr double kTracked_m = 0.001, kTracked_rad = 0.0009;

// Returns the weight of each of `observation_count` keypoints of a keyframe, relative to one with
// an independent error. Dense tracking placed the keyframe in its submap; a rotation error of
// kTracked_rad moves all its keypoints by the same s = focal length * kTracked_rad pixels, in
// addition to the pixel of independent noise of each. Their errors correlate by rho = s^2 / (s^2 +
// 1), so n of them carry the information of n / (1 + (n - 1) rho) independent ones. At 640x480 that
// is never more than five or six.
double weight_of_observation(std::size_t observation_count, double focal_length_px);

// The 95 % quantiles of the chi-square distribution: a pixel (2), a pixel with depth (3), a
// relative pose (6 degrees of freedom).
inline constexpr double kPixelChi2 = 5.991;
inline constexpr double kPixelAndDepthChi2 = 7.815;
inline constexpr double kPoseChi2 = 12.592;

}  // namespace hermite::adjust
