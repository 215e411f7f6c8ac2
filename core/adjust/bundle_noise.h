// How well a keypoint's pixel and depth are known, and when a residual is too large to belong to them.
#pragma once

namespace hermite {

// The standard deviation [m] of a structured-light depth [m]: 0.00273 z^2 + 0.00074 z - 0.00058 (notes section 5.2, Khoshelham's form).
// That crosses zero at 0.345 m and would weigh a near point without bound, so it is never below a millimetre: what one step of the
// sensor's depth and the registration to colour leave at best.
double depth_deviation_m(double depth_m);

// The 95 % quantiles of the chi-square distribution: a pixel (2), a pixel with depth (3), a relative pose (6 degrees of freedom).
inline constexpr double kPixelChi2 = 5.991;
inline constexpr double kPixelAndDepthChi2 = 7.815;
inline constexpr double kPoseChi2 = 12.592;

}  // namespace hermite
