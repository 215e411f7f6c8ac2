#include "core/calibrate/patches.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "core/adjust/bundle_noise.h"

namespace hermite::calibrate {
namespace {

// Shares of the image's width: at 640 pixels a node every 4 pixels and a window of 9, about 3 cm at
// 2 m. A Kinect's noise tilts the plane of such a window by 3 to 5 degrees, half as much as that of
// the cells of depth_planes.h.
constexpr int kStepShare = 160, kRadiusShare = 160;

// The bound of the root mean square of a window's pixels about their plane, in standard deviations
// of a pixel, as in depth_planes.cpp.
constexpr double kFlat = 1.5;

// The share of a window's pixels that must have depth. Cameras that see little, or through a second
// projector's light, have hardly a window without a hole; along an edge, where depth is less exact,
// more than a quarter is missing.
constexpr double kLeastMeasured = 0.75;

// Cosine of the largest angle between the plane's normal and the ray to it, 72 degrees.
constexpr float kSteepestCosine = 0.3f;

// Fits a plane to the window's pixels with depth by least squares.
DepthPatch patch_at(const Image<float>& inverse, int u, int v, int radius) {
  const float middle = inverse.at(u, v);
  if (middle == 0) return {};
  double squares = 0;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) {
      const float value = inverse.at(u + x, v + y);
      if (value == 0) continue;
      // So that the squares do not lose digits.
      const double off = static_cast<double>(value) - static_cast<double>(middle);
      const Eigen::Vector3d place(1, x, y);
      squares += off * off;
      normal += place * place.transpose();
      right += off * place;
    }
  const double count = normal(0, 0), side = 2 * radius + 1;
  if (count < kLeastMeasured * side * side) return {};
  const Eigen::Vector3d plane = normal.ldlt().solve(right);  // at the centre, per u, per v
  const double variance = (squares - plane.dot(right)) / count;
  const double inverse_per_m = static_cast<double>(middle) + plane[0];
  const double bound =
      kFlat * adjust::depth_deviation_m(1 / inverse_per_m) * inverse_per_m * inverse_per_m;
  if (!(variance <= bound * bound)) return {};
  return {static_cast<float>(inverse_per_m), static_cast<float>(plane[1]),
          static_cast<float>(plane[2])};
}

// Where a patch lies in the undistorted image, and how its inverse depth grows there [1 / (m px)].
struct StraightPatch {
  Eigen::Vector2d at_px, per_px;
};

StraightPatch straightened(const DepthPatch& patch, const Eigen::Vector2d& pixel_px,
                           const Camera& camera) {
  const Eigen::Vector2d per_px = Eigen::Vector2f(patch.per_u, patch.per_v).cast<double>();
  if (camera.distortion == Distortion{}) return {pixel_px, per_px};
  const Eigen::Vector2d at_px = camera.undistort(pixel_px.x(), pixel_px.y());
  // Half a pixel to either side.
  Eigen::Matrix2d distorted_by_straight;
  for (int axis = 0; axis < 2; ++axis) {
    const Eigen::Vector2d half = 0.5 * Eigen::Vector2d::Unit(axis), ahead = at_px + half,
                          behind = at_px - half;
    distorted_by_straight.col(axis) =
        camera.distort(ahead.x(), ahead.y()) - camera.distort(behind.x(), behind.y());
  }
  return {at_px, distorted_by_straight.transpose() * per_px};
}

}  // namespace

PatchGrid patches_of(const DepthImage& depth, const Camera& camera) {
  Image<float> inverse(depth.width, depth.height);
  for (std::size_t i = 0; i < inverse.pixels.size(); ++i) {
    const double depth_m = depth.pixels[i] / camera.depth_units_per_metre;
    if (depth_m >= kNearestPatch_m && depth_m <= kFarthestPatch_m)
      inverse.pixels[i] = static_cast<float>(1 / depth_m);
  }
  const int step = std::max(1, camera.width / kStepShare),
            radius = std::max(1, camera.width / kRadiusShare);
  PatchGrid grid{step, Image<DepthPatch>(camera.width / step, camera.height / step)};
  for (int row = 0; row < grid.nodes.height; ++row)
    for (int column = 0; column < grid.nodes.width; ++column) {
      const int u = grid.pixel_of(column), v = grid.pixel_of(row);
      if (std::min(u, v) >= radius && u + radius < camera.width && v + radius < camera.height)
        grid.nodes.at(column, row) = patch_at(inverse, u, v, radius);
    }
  return grid;
}

std::vector<Facet> facets_of(const PatchGrid& grid, const Camera& camera) {
  const double middle_x = 0.5 * (camera.width - 1), middle_y = 0.5 * (camera.height - 1);
  const double corner2 = middle_x * middle_x + middle_y * middle_y;
  std::vector<Facet> facets(grid.nodes.pixels.size());
  for (int row = 0; row < grid.nodes.height; ++row)
    for (int column = 0; column < grid.nodes.width; ++column) {
      const DepthPatch& patch = grid.nodes.at(column, row);
      if (patch.inverse_per_m == 0) continue;
      const StraightPatch straight =
          straightened(patch, {grid.pixel_of(column), grid.pixel_of(row)}, camera);
      const double u = straight.at_px.x(), v = straight.at_px.y(),
                   w = static_cast<double>(patch.inverse_per_m);
      const DepthCorrection& correction = camera.depth_correction;
      // The plane of the corrected inverse depth, (w / factor + offset) / scale.
      const double factor = 1 + correction.bend * camera.rho2(u, v),
                   scale = 1 + correction.inverse_offset_per_m * kUndistortedDepth_m;
      const double inverse_per_m = (w / factor + correction.inverse_offset_per_m) / scale;
      if (!(inverse_per_m > 0)) continue;
      const double bent = 2 * correction.bend * w / (factor * factor * corner2);
      const double per_u = (straight.per_px.x() / factor - bent * (u - middle_x)) / scale;
      const double per_v = (straight.per_px.y() / factor - bent * (v - middle_y)) / scale;
      const Eigen::Vector3d plane(
          per_u * camera.fx, per_v * camera.fy,
          inverse_per_m - per_u * (u - camera.cx) - per_v * (v - camera.cy));
      const Eigen::Vector3d point = camera.unproject(u, v, 1 / inverse_per_m);
      if (1 < static_cast<double>(kSteepestCosine) * plane.norm() * point.norm()) continue;
      facets[grid.nodes.index(column, row)] = {point.cast<float>(), plane.cast<float>()};
    }
  return facets;
}

}  // namespace hermite::calibrate
