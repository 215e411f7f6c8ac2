// What of a frame's depth calibration works with: small planes all over the image, in the sensor's own numbers, so that they can be placed
// in space anew for every camera that is tried. Plain values, pure functions, any thread.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/image.h"
#include "core/math/camera.h"

namespace hermite {

// Depth that is used: nearer a Kinect sees nothing, farther the noise of one pixel passes 5 cm.
inline constexpr double kNearestPatch_m = 0.4, kFarthestPatch_m = 4.5;

// 1 / measured depth over the pixels of a plane is linear: inverse_per_m + per_u (u - u0) + per_v (v - v0) around the node's pixel. The
// inverse is 0 where there is no plane to be trusted: at edges, without depth, beyond the range, where the pixels are off it by more than
// noise.
struct Patch {
  float inverse_per_m = 0;
  float per_u = 0, per_v = 0;  // 1 / (m px)
};

// Nodes every `step_px`, row major, the first half a step from the corner: 160x120 of an image of 640x480.
struct PatchGrid {
  int step_px = 0;
  Image<Patch> nodes;

  int pixel_of(int column_or_row) const { return column_or_row * step_px + step_px / 2; }
};

// `depth` is as measured (no Camera::depth_correction applied), straight and of the camera's size.
PatchGrid patches_of(const DepthImage& depth, const Camera& camera);

// A patch in space, in the camera's frame. The points of the plane are those with plane . point = 1 [1/m]; zero: none.
struct Facet {
  Eigen::Vector3f point_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f plane_per_m = Eigen::Vector3f::Zero();
};

// By node. No distortion of the lens, but the camera's of depth. None where the plane is seen under more than 72 degrees.
std::vector<Facet> facets_of(const PatchGrid& grid, const Camera& camera);

}  // namespace hermite
