#include "core/disturb/moved_view.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/disturb/true_view.h"

namespace hermite::disturb {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kSteps = 12;
constexpr double kSettled_m = 1e-5;
// As a share of the depth: a ray whose iteration still changes by more lies between two surfaces.
constexpr double kUnsettled = 0.003;
// Ratio of depths above which neighbours lie on two surfaces.
constexpr double kOneSurface = 1.03;

// The pixel above and to the left of a position, and the offset of the position from it.
struct PixelCell {
  int x = 0, y = 0;
  double right = 0, down = 0;
};
PixelCell cell_at(const Vector2d& at_px, int width, int height) {
  const int x = std::clamp(static_cast<int>(at_px.x()), 0, width - 2),
            y = std::clamp(static_cast<int>(at_px.y()), 0, height - 2);
  return {x, y, at_px.x() - x, at_px.y() - y};
}

}  // namespace

// In the image, the inverse depth of a plane is linear.
double MovedView::depth_at_m(const Vector2d& at_px) const {
  const PixelCell cell = cell_at(at_px, depth_.width, depth_.height);
  const std::array<double, 4> units = {static_cast<double>(depth_.at(cell.x, cell.y)),
                                       static_cast<double>(depth_.at(cell.x + 1, cell.y)),
                                       static_cast<double>(depth_.at(cell.x, cell.y + 1)),
                                       static_cast<double>(depth_.at(cell.x + 1, cell.y + 1))};
  const auto [least, greatest] = std::minmax_element(units.begin(), units.end());
  const double scale = camera_.depth_units_per_metre;
  if (*least == 0 || *greatest > kOneSurface * *least)
    return units[(cell.right >= 0.5 ? 1 : 0) + (cell.down >= 0.5 ? 2 : 0)] / scale;
  const double above = (1 - cell.right) / units[0] + cell.right / units[1],
               below = (1 - cell.right) / units[2] + cell.right / units[3];
  return 1 / (scale * ((1 - cell.down) * above + cell.down * below));
}

SeenPlace MovedView::find(int x, int y, const Rigid3& frame_from_moved) const {
  const Matrix3d rotation = frame_from_moved.rotation.toRotationMatrix();
  const Vector3d ray = rotation * rays_.at(x, y);
  SeenPlace seen{Vector2d(x, y), depth_.at(x, y) / camera_.depth_units_per_metre};
  double change_m = 0;
  for (int step = 0; step < kSteps; ++step) {
    const Vector3d direction =
        seen.depth_m > 0 ? Vector3d(seen.depth_m * ray + frame_from_moved.translation) : ray;
    if (direction.z() <= 0) return {seen.at_px, 0};
    const Vector2d wanted_px = pixel_of(camera_, direction);
    seen.at_px = wanted_px.cwiseMax(0).cwiseMin(Vector2d(depth_.width - 1, depth_.height - 1));
    if ((wanted_px - seen.at_px).lpNorm<Eigen::Infinity>() > 0.5) return {seen.at_px, 0};
    const double frame_depth_m = depth_at_m(seen.at_px);
    if (frame_depth_m == 0 && seen.depth_m == 0) return seen;
    const Vector3d point_in_frame = frame_depth_m / direction.z() * direction;
    const double depth_m =
        frame_depth_m > 0
            ? std::max(0.0, rotation.col(2).dot(point_in_frame - frame_from_moved.translation))
            : 0;
    change_m = std::abs(depth_m - seen.depth_m);
    seen.depth_m = depth_m;
    if (change_m < kSettled_m) return seen;
  }
  if (change_m > kUnsettled * seen.depth_m) seen.depth_m = 0;
  return seen;
}

Vector3d color_at(const ColorImage& color, const Vector2d& at_px) {
  const PixelCell cell = cell_at(at_px, color.width, color.height);
  const auto pixel = [&](int dx, int dy) {
    const Rgb8& rgb = color.at(cell.x + dx, cell.y + dy);
    return Vector3d(rgb.r, rgb.g, rgb.b);
  };
  const Vector3d above = (1 - cell.right) * pixel(0, 0) + cell.right * pixel(1, 0),
                 below = (1 - cell.right) * pixel(0, 1) + cell.right * pixel(1, 1);
  return (1 - cell.down) * above + cell.down * below;
}

Rgb8 rounded(const Vector3d& color) {
  const auto byte = [](double value) {
    return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
  };
  return {byte(color.x()), byte(color.y()), byte(color.z())};
}

}  // namespace hermite::disturb
