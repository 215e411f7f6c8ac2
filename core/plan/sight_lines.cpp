#include "core/plan/sight_lines.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/dataset/trajectory_formats.h"

namespace hermite::plan {

namespace {

using Eigen::Vector3d;

// As cameras with depth see (core/measure/camera_way.h): nearly 60 by 45 degrees, up to 5 m.
constexpr double kHalfView = 0.53, kNearest_m = 0.3, kFarthest_m = 5;  // tangent of the half angle
// Pixels of two degrees, in both directions.
constexpr int kPixels = 32;
constexpr double kPixel = 2 * kHalfView / kPixels;
// Least cosine between a facet's normal and the direction to the camera.
constexpr double kFacing = 0.15;
// Distance by which a line ends before its surface: more than walls are uneven.
constexpr double kBefore_m = 0.06;
// Cameras closer to each other than both of these see the same.
constexpr double kMoved_m = 0.2, kTurned_rad = 0.2;
constexpr std::size_t kMostCameras = 600;
constexpr double kFacetRadius_m = 0.6 * kFacet_m;

struct View {
  Eigen::Matrix3d camera_from_plan;
  Vector3d at_m;
};

std::vector<View> views_of(const PlanFrame& frame, const dataset::Trajectory& path) {
  const std::vector<bool> tracked = dataset::tracked_frames(path);
  std::vector<View> views;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!tracked[i]) continue;
    const Eigen::Matrix3d plan_from_camera =
        frame.plan_from_world * path[i].world_from_camera.rotation.toRotationMatrix();
    const Vector3d at_m = frame.to_plan(path[i].world_from_camera.translation);
    if (!views.empty()) {
      const double cosine = 0.5 * ((views.back().camera_from_plan * plan_from_camera).trace() - 1);
      if ((at_m - views.back().at_m).norm() < kMoved_m && cosine > std::cos(kTurned_rad)) continue;
    }
    views.push_back({plan_from_camera.transpose(), at_m});
  }
  if (views.size() <= kMostCameras) return views;
  std::vector<View> some;
  for (std::size_t i = 0; i < kMostCameras; ++i)
    some.push_back(views[i * views.size() / kMostCameras]);
  return some;
}

// The distance of the nearest surface in each direction.
class NearestSurface {
 public:
  void see(const View& view, const PlanFacet& facet) {
    const Vector3d off_m = facet.at_m - view.at_m;
    if (off_m.squaredNorm() > kFarthest_m * kFarthest_m) return;
    const Vector3d seen = view.camera_from_plan * off_m;
    if (seen.z() < kNearest_m) return;
    const double x = seen.x() / seen.z(), y = seen.y() / seen.z(),
                 radius = kFacetRadius_m / seen.z();
    if (std::abs(x) > kHalfView || std::abs(y) > kHalfView) return;
    // What faces away was not seen from here, but it hides what is behind it.
    const bool is_seen = -facet.normal.dot(off_m) >= kFacing * off_m.norm();
    for (int row = pixel_of(y - radius); row <= pixel_of(y + radius); ++row)
      for (int column = pixel_of(x - radius); column <= pixel_of(x + radius); ++column) {
        Pixel& pixel = pixels_[static_cast<std::size_t>(row * kPixels + column)];
        if (pixel.depth_m == 0 || seen.z() < pixel.depth_m) pixel = {seen.z(), is_seen};
      }
  }

  void append_lines(const View& view, std::vector<SightLine>& lines) const {
    for (int row = 0; row < kPixels; ++row)
      for (int column = 0; column < kPixels; ++column) {
        const Pixel& pixel = pixels_[static_cast<std::size_t>(row * kPixels + column)];
        if (!pixel.is_seen) continue;
        const Vector3d ray =
            view.camera_from_plan.transpose() * Vector3d(place_of(column), place_of(row), 1);
        const double reach = pixel.depth_m - kBefore_m / ray.norm();
        if (reach > 0) lines.push_back({view.at_m, view.at_m + reach * ray});
      }
  }

 private:
  struct Pixel {
    double depth_m = 0;  // 0: nothing is there
    bool is_seen = false;
  };
  static int pixel_of(double tangent) {
    return std::clamp(static_cast<int>((tangent + kHalfView) / kPixel), 0, kPixels - 1);
  }
  static double place_of(int pixel) { return (pixel + 0.5) * kPixel - kHalfView; }
  std::array<Pixel, kPixels * kPixels> pixels_{};
};

}  // namespace

std::vector<SightLine> sight_lines_of(const PlanSurface& surface, const dataset::Trajectory& path) {
  std::vector<SightLine> lines;
  for (const View& view : views_of(surface.frame, path)) {
    NearestSurface nearest;
    for (const PlanFacet& facet : surface.facets) nearest.see(view, facet);
    nearest.append_lines(view, lines);
  }
  return lines;
}

}  // namespace hermite::plan
