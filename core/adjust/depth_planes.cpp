#include "core/adjust/depth_planes.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/adjust/bundle_noise.h"
#include "core/adjust/features.h"

namespace hermite::adjust {

namespace {

constexpr int kColumns = 80;

// Bounds in standard deviations of a pixel's inverse depth: of the root mean square of the
// distances of a cell's pixels from its plane, and of the height of a ridge or depth of a valley,
// as a template of unit length measures it. The results on the loop scenes and on redkitchen do not
// change from 1 to 1.5 and from 2 to 3 (tests/accuracy/LAB.md).
constexpr double kFlat = 1.5, kCreased = 2.5;

// Least cosine of the angle between the plane's normal and the ray to it.
constexpr double kSteepestCosine = 0.3;

// Inverse depth is linear over the image of a plane. 0: no depth in the trusted range.
using InverseDepth = Image<float>;  // [1/m]

InverseDepth inverse_of(const DepthImage& depth, const Camera& camera) {
  InverseDepth inverse(depth.width, depth.height);
  for (std::size_t i = 0; i < inverse.pixels.size(); ++i) {
    const double depth_m = depth.pixels[i] / camera.depth_units_per_metre;
    if (depth_m >= kMinFeatureDepth_m && depth_m <= kMaxFeatureDepth_m)
      inverse.pixels[i] = static_cast<float>(1 / depth_m);
  }
  return inverse;
}

double deviation_per_m(double inverse_depth_per_m) {
  return depth_deviation_m(1 / inverse_depth_per_m) * inverse_depth_per_m * inverse_depth_per_m;
}

// Returns templates of ridges through the centre of a square in four directions, per pixel, row
// major. Each has unit length and zero mean.
std::vector<std::array<double, 4>> ridges_of(int half_px) {
  std::vector<std::array<double, 4>> ridges;
  for (int y = -half_px; y <= half_px; ++y)
    for (int x = -half_px; x <= half_px; ++x) {
      ridges.emplace_back();
      for (std::size_t i = 0; i < 4; ++i) {
        const double direction_rad = static_cast<double>(i) * std::numbers::pi / 4;
        ridges.back()[i] = std::abs(x * std::cos(direction_rad) + y * std::sin(direction_rad));
      }
    }
  for (std::size_t i = 0; i < 4; ++i) {
    double mean = 0, square = 0;
    for (const auto& pixel : ridges) mean += pixel[i] / static_cast<double>(ridges.size());
    for (const auto& pixel : ridges) square += (pixel[i] - mean) * (pixel[i] - mean);
    for (auto& pixel : ridges) pixel[i] = (pixel[i] - mean) / std::sqrt(square);
  }
  return ridges;
}

// Fits a plane to inverse depth over the square around (u, v) by least squares. Returns zero if
// there is none.
Eigen::Vector3d plane_at(const InverseDepth& inverse, const Camera& camera, int u, int v,
                         int half_px) {
  double sum = 0, squares = 0, by_x = 0, by_y = 0, xx = 0;
  for (int y = -half_px; y <= half_px; ++y)
    for (int x = -half_px; x <= half_px; ++x) {
      const double value = inverse.at(u + x, v + y);
      if (value == 0) return Eigen::Vector3d::Zero();
      sum += value;
      squares += value * value;
      by_x += value * x;
      by_y += value * y;
      xx += x * x;
    }
  const double count = (2 * half_px + 1) * (2 * half_px + 1), mean = sum / count, per_u = by_x / xx,
               per_v = by_y / xx;
  const double variance =
      squares / count - mean * mean - (per_u * per_u + per_v * per_v) * xx / count;
  const double bound = kFlat * deviation_per_m(mean);
  if (variance > bound * bound) return Eigen::Vector3d::Zero();
  const Eigen::Vector3d plane(per_u * camera.fx, per_v * camera.fy,
                              mean - per_u * (u - camera.cx) - per_v * (v - camera.cy));
  const Eigen::Vector3d ray = camera.unproject(u, v, 1);
  return plane.dot(ray) < kSteepestCosine * plane.norm() * ray.norm() ? Eigen::Vector3d::Zero()
                                                                      : plane;
}

// Returns true if a pixel around (u, v) has no depth, or if there is a crease.
bool is_broken(const InverseDepth& inverse, int u, int v, int half_px,
               const std::vector<std::array<double, 4>>& ridges) {
  std::array<double, 4> heights{};
  auto ridge = ridges.begin();
  for (int y = v - half_px; y <= v + half_px; ++y)
    for (int x = u - half_px; x <= u + half_px; ++x, ++ridge) {
      const double value = inverse.at(x, y);
      if (value == 0) return true;
      for (std::size_t i = 0; i < 4; ++i) heights[i] += (*ridge)[i] * value;
    }
  const double bound = kCreased * deviation_per_m(inverse.at(u, v));
  return std::any_of(heights.begin(), heights.end(),
                     [bound](double height) { return std::abs(height) > bound; });
}

}  // namespace

DepthGrid depth_grid_of(const Camera& camera) {
  const int cell_px = std::max(2, camera.width / kColumns);
  return {cell_px, camera.width / cell_px, camera.height / cell_px};
}

std::vector<DepthPlane> fit_depth_planes(const DepthImage& depth, const Camera& camera) {
  const DepthGrid grid = depth_grid_of(camera);
  const int around_px = grid.cell_px, in_px = grid.cell_px / 2;
  const InverseDepth inverse = inverse_of(depth, camera);
  const std::vector<std::array<double, 4>> ridges = ridges_of(around_px);
  std::vector<DepthPlane> planes;
  planes.reserve(grid.count());
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      planes.push_back({});
      const int u = grid.center_px(column), v = grid.center_px(row);
      if (std::min(u, v) < around_px || u + around_px >= camera.width ||
          v + around_px >= camera.height)
        continue;
      const Eigen::Vector3d plane = plane_at(inverse, camera, u, v, in_px);
      if (plane.isZero() || is_broken(inverse, u, v, around_px, ridges)) continue;
      for (int i = 0; i < 3; ++i)
        planes.back()[static_cast<std::size_t>(i)] = static_cast<float>(plane[i]);
    }
  return planes;
}

}  // namespace hermite::adjust
