#include "core/track/seen_twice.h"

#include <algorithm>
#include <cmath>

#include "core/math/rigid3_fields.h"

namespace hermite::track {

namespace {

// Distance up to which two points are the same place: a coarse pixel covers two centimetres at 1.5
// m, and depth may be bent by one or two percent.
constexpr double kSame_m = 0.02, kSameGrowth_per_m = 0.01;

constexpr double kLeastInCommon = 0.4;

}  // namespace

double squared_image_distance(const shared::Intrinsics& camera, double x, double y) {
  const double cx = camera.cx, cy = camera.cy;
  const double farthest_x = std::max(cx, camera.width - 1 - cx),
               farthest_y = std::max(cy, camera.height - 1 - cy);
  return std::min(1.0, ((x - cx) * (x - cx) + (y - cy) * (y - cy)) /
                           (farthest_x * farthest_x + farthest_y * farthest_y));
}

std::optional<EarlierView::Comparison> EarlierView::compare(const frame::CoarseView& now,
                                                            const Rigid3& world_from_camera,
                                                            const frame::CoarseMask& moving) const {
  if (view_.empty()) return std::nullopt;
  Comparison result{view_, inverse(world_from_camera_) * world_from_camera, {}};
  for (int y = 0; y < static_cast<int>(now.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(now.camera.width); ++x) {
      const std::size_t i = now.index(x, y);
      if (now.depth_m[i] <= 0 || moving[i] != 0) continue;
      const Eigen::Vector3d point = result.earlier_from_now * now.point(x, y);
      if (point.z() < 0.05) continue;
      const Eigen::Vector2d uv = view_.project(point);
      const int u = static_cast<int>(std::lround(uv.x())),
                v = static_cast<int>(std::lround(uv.y()));
      if (!view_.contains(u, v) || view_.depth_m[view_.index(u, v)] <= 0) continue;
      const double apart_m =
          view_.normals[view_.index(u, v)].cast<double>().dot(point - view_.point(u, v));
      if (std::abs(apart_m) < kSame_m + kSameGrowth_per_m * point.z() * point.z())
        result.places.push_back({x, y, u, v});
    }
  return result;
}

void EarlierView::keep(const frame::CoarseView& now, const Rigid3& world_from_camera,
                       const frame::CoarseMask& moving, std::size_t places_found) {
  if (static_cast<double>(places_found) >= kLeastInCommon * static_cast<double>(now.size())) return;
  view_ = now;
  world_from_camera_ = world_from_camera;
  for (std::size_t i = 0; i < moving.size(); ++i)
    if (moving[i] != 0) view_.depth_m[i] = 0;
}

void EarlierView::save(ByteWriter& bytes) const {
  frame::save(bytes, view_);
  rigid3_fields(bytes, world_from_camera_);
}

void EarlierView::restore(ByteReader& bytes) {
  frame::restore(bytes, view_);
  rigid3_fields(bytes, world_from_camera_);
}

}  // namespace hermite::track
