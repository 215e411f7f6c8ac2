// A frame's depth as calibration uses it: small planes all over the image, in the sensor's raw
// values, so that they can be placed in space again for every trial camera. Plain values, pure
// functions, any thread.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/image.h"
#include "core/math/camera.h"

namespace hermite::calibrate {

// The depth range in use: nearer, a Kinect measures nothing; farther, the noise of one pixel
// exceeds 5 cm.
inline constexpr double kNearestPatch_m = 0.4, kFarthestPatch_m = 4.5;

// Over the pixels of a plane, 1 / measured depth is linear: inverse_per_m + per_u (u - u0) + per_v
// (v - v0) around the node's pixel. The inverse is 0 if there is no reliable plane: at edges,
// without depth, out of range, or if the pixels deviate from it by more than noise.
struct DepthPatch {
  float inverse_per_m = 0;
  float per_u = 0, per_v = 0;  // 1 / (m px)
};

// A node every `step_px` pixels, row major, the first one half a step from the corner: 160x120 for
// an image of 640x480.
struct PatchGrid {
  int step_px = 0;
  Image<DepthPatch> nodes;

  int pixel_of(int column_or_row) const { return column_or_row * step_px + step_px / 2; }
};

// `depth` is as measured (without Camera::depth_correction), rectified, and has the camera's size.
PatchGrid patches_of(const DepthImage& depth, const Camera& camera);

// A patch in space, in the camera frame. Points of its plane satisfy plane . point = 1 [1/m]; zero:
// no plane.
struct Facet {
  Eigen::Vector3f point_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f plane_per_m = Eigen::Vector3f::Zero();
};

// Returns a facet per node, with the camera's depth correction and lens distortion. A facet is zero
// if the plane is seen at more than 72 degrees from its normal.
std::vector<Facet> facets_of(const PatchGrid& grid, const Camera& camera);

}  // namespace hermite::calibrate
