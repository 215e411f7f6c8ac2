#include "core/compare/sight.h"

#include <algorithm>
#include <cmath>

#include "core/base/parallel.h"

namespace hermite::compare {

namespace {

using Eigen::Vector3d;

constexpr int kWidth_px = 200, kHeight_px = 150;
constexpr double kHalfField_rad = 28.5 * M_PI / 180;
// A pose is another view if it is this far from all views before, by place or direction.
constexpr double kOtherPlace_m = 0.2, kOtherDirection_rad = 15 * M_PI / 180;
constexpr double kNearest_m = 0.2, kFarthest_m = 6;
// The surface is drawn as discs, which cover it without gaps: of samples this far apart, so much
// larger, and at least this large in the image.
constexpr double kDrawnSpacing_m = 0.015, kEnlarged = 1.1, kLeastRadius_px = 1.1;
constexpr std::size_t kMostSamples = 1'000'000;
constexpr double kMostRadius_px = 12;

Camera small_camera() {
  const double focal_px = kWidth_px / 2.0 / std::tan(kHalfField_rad);
  return {kWidth_px, kHeight_px, focal_px, focal_px, (kWidth_px - 1) / 2.0, (kHeight_px - 1) / 2.0};
}

std::vector<Rigid3> spread_poses(const dataset::Trajectory& trajectory) {
  std::vector<Rigid3> poses;
  for (const dataset::TimedPose& pose : trajectory) {
    const Rigid3& here = pose.world_from_camera;
    const bool is_known = std::any_of(poses.begin(), poses.end(), [&](const Rigid3& other) {
      return (other.translation - here.translation).norm() < kOtherPlace_m &&
             angle_rad(other.rotation.conjugate() * here.rotation) < kOtherDirection_rad;
    });
    if (!is_known) poses.push_back(here);
  }
  if (poses.size() <= Sight::kMostViews) return poses;
  std::vector<Rigid3> fewer;
  for (std::size_t i = 0; i < Sight::kMostViews; ++i)
    fewer.push_back(poses[i * poses.size() / Sight::kMostViews]);
  return fewer;
}

struct Disc {
  Vector3d centre_m, normal;  // in the camera frame
  double radius_m;
};

void draw(const Disc& disc, const Camera& camera, Image<float>& depth_m) {
  const Eigen::Vector2d middle_px = camera.project(disc.centre_m);
  const double radius_px =
      std::clamp(camera.fx * disc.radius_m / disc.centre_m.z(), kLeastRadius_px, kMostRadius_px);
  const int left = std::max(0, static_cast<int>(std::ceil(middle_px.x() - radius_px))),
            right =
                std::min(camera.width - 1, static_cast<int>(std::floor(middle_px.x() + radius_px))),
            top = std::max(0, static_cast<int>(std::ceil(middle_px.y() - radius_px))),
            bottom = std::min(camera.height - 1,
                              static_cast<int>(std::floor(middle_px.y() + radius_px)));
  const double offset = disc.normal.dot(disc.centre_m);
  for (int y = top; y <= bottom; ++y)
    for (int x = left; x <= right; ++x) {
      if (std::hypot(x - middle_px.x(), y - middle_px.y()) > radius_px) continue;
      const double slope =
          disc.normal.dot(Vector3d((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1));
      const double on_plane_m = std::abs(slope) > 1e-3 ? offset / slope : disc.centre_m.z();
      const auto z_m = static_cast<float>(std::clamp(on_plane_m, disc.centre_m.z() - disc.radius_m,
                                                     disc.centre_m.z() + disc.radius_m));
      float& there = depth_m.at(x, y);
      if (there == 0 || z_m < there) there = z_m;
    }
}

}  // namespace

Sight::Sight(const ComparedScan& scan) : camera_(small_camera()) {
  const std::vector<Rigid3> poses = spread_poses(scan.trajectory());
  if (poses.empty()) return;
  const SurfaceSamples surface = surface_samples(scan.surfels(), kDrawnSpacing_m, kMostSamples);
  views_.resize(poses.size());
  in_parallel(poses.size(), [&](std::size_t i) { views_[i] = view_of(surface, poses[i]); });
}

Sight::View Sight::view_of(const SurfaceSamples& surface, const Rigid3& world_from_camera) const {
  View view{inverse(world_from_camera), Image<float>(camera_.width, camera_.height)};
  std::fill(view.depth_m.pixels.begin(), view.depth_m.pixels.end(), 0.0f);
  const Eigen::Matrix3d rotation = view.camera_from_world.rotation.toRotationMatrix();
  for (const SurfaceSample& sample : surface.samples) {
    const Vector3d centre_m = rotation * sample.position_m + view.camera_from_world.translation;
    if (centre_m.z() < kNearest_m || centre_m.z() > kFarthest_m) continue;
    draw({centre_m, rotation * sample.normal, kEnlarged * surface.spacing_m}, camera_,
         view.depth_m);
  }
  return view;
}

bool Sight::looked_through(const View& view, const Vector3d& point_in_world,
                           double margin_m) const {
  const Vector3d point = view.camera_from_world * point_in_world;
  if (point.z() < kNearest_m) return false;
  const Eigen::Vector2d pixel_px = camera_.project(point);
  if (!(pixel_px.x() >= 1 && pixel_px.y() >= 1 && pixel_px.x() <= camera_.width - 2 &&
        pixel_px.y() <= camera_.height - 2))
    return false;
  const int column = static_cast<int>(std::lround(pixel_px.x())),
            row = static_cast<int>(std::lround(pixel_px.y()));
  for (int y = row - 1; y <= row + 1; ++y)
    for (int x = column - 1; x <= column + 1; ++x)
      if (view.depth_m.at(x, y) < point.z() + margin_m) return false;
  return true;
}

bool Sight::looked_through(const Vector3d& point_in_world, double margin_m) const {
  return std::any_of(views_.begin(), views_.end(), [&](const View& view) {
    return looked_through(view, point_in_world, margin_m);
  });
}

}  // namespace hermite::compare
