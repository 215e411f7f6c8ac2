// How well a keypoint's pixel and depth are known, and when a residual is too large to belong to them.
#pragma once

#include <cstddef>

namespace hermite {

// The standard deviation [m] of a structured-light depth [m]: 0.00273 z^2 + 0.00074 z - 0.00058 (notes section 5.2).
// That crosses zero at 0.345 m and would weigh a near point without bound, so it is never below a millimetre: what one step of the
// sensor's depth and the registration to colour leave at best.
double depth_deviation_m(double depth_m);

// What dense tracking from one view to the next is off by at least [m, rad]: a millimetre, a twentieth of a degree.
inline constexpr double kTracked_m = 0.001, kTracked_rad = 0.0009;

// How much each of `observation_count` keypoints of a keyframe tells beside one whose error is all its own. The keyframe stands in its
// submap as dense tracking put it, and turned by kTracked_rad all its keypoints are off by the same s = focal length * kTracked_rad pixels,
// beside the pixel that each is off by itself: their errors correlate by rho = s^2 / (s^2 + 1), and n of them tell as much as
// n / (1 + (n - 1) rho) independent ones. At 640x480 that is never more than five or six.
double weight_of_observation(std::size_t observation_count, double focal_length_px);

// The 95 % quantiles of the chi-square distribution: a pixel (2), a pixel with depth (3), a relative pose (6 degrees of freedom).
inline constexpr double kPixelChi2 = 5.991;
inline constexpr double kPixelAndDepthChi2 = 7.815;
inline constexpr double kPoseChi2 = 12.592;

}  // namespace hermite
