#include "core/disturb/seen_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/disturb/true_view.h"

namespace hermite::disturb {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr std::int64_t kMostFrames = 24;
constexpr int kPointsAcross = 160;
constexpr double kSameSurface = 1.05;
constexpr double kNearestDrawn_m = 0.1;
constexpr std::uint32_t kNoPoint = std::numeric_limits<std::uint32_t>::max();

void append_seen(const frame::RgbdFrame& frame, const Camera& camera,
                 const Rigid3& world_from_camera, SeenSurface& surface) {
  const int step = std::max(1, camera.width / kPointsAcross);
  const auto first = static_cast<std::uint32_t>(surface.points.size());
  Image<std::uint32_t> point_of((camera.width - 1) / step + 1, (camera.height - 1) / step + 1);
  std::vector<double> depths_m;  // of the points of this frame
  for (int y = 0; y < point_of.height; ++y)
    for (int x = 0; x < point_of.width; ++x) {
      point_of.at(x, y) = kNoPoint;
      const double depth_m = frame.depth.at(step * x, step * y) / camera.depth_units_per_metre;
      if (depth_m == 0) continue;
      const Rgb8& color = frame.color.at(step * x, step * y);
      point_of.at(x, y) = static_cast<std::uint32_t>(surface.points.size());
      surface.points.push_back(
          {world_from_camera * Vector3d(depth_m * ray_of(camera, step * x, step * y)),
           Eigen::Vector3f(color.r, color.g, color.b)});
      depths_m.push_back(depth_m);
    }
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    if (a == kNoPoint || b == kNoPoint || c == kNoPoint) return;
    const auto [least, greatest] =
        std::minmax({depths_m[a - first], depths_m[b - first], depths_m[c - first]});
    if (greatest <= kSameSurface * least) surface.triangles.push_back({a, b, c});
  };
  for (int y = 0; y + 1 < point_of.height; ++y)
    for (int x = 0; x + 1 < point_of.width; ++x) {
      add(point_of.at(x, y), point_of.at(x + 1, y), point_of.at(x, y + 1));
      add(point_of.at(x + 1, y), point_of.at(x + 1, y + 1), point_of.at(x, y + 1));
    }
}

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

// The part of a point's projection that does not depend on the triangle.
struct Projected {
  Vector2d at_px = Vector2d::Zero();
  double inverse_depth = 0;  // 0: not in front of the camera
};

struct Box {
  int left = 0, top = 0, right = -1, bottom = -1;  // inclusive
};

Box box_of(const Image<std::uint8_t>& is_asked) {
  Box box{is_asked.width, is_asked.height, -1, -1};
  for (int y = 0; y < is_asked.height; ++y)
    for (int x = 0; x < is_asked.width; ++x)
      if (is_asked.at(x, y))
        box = {std::min(box.left, x), std::min(box.top, y), std::max(box.right, x),
               std::max(box.bottom, y)};
  return box;
}

}  // namespace

SeenSurface seen_surface(const dataset::Sequence& sequence) {
  SeenSurface surface;
  const std::int64_t stride =
      std::max<std::int64_t>(1, (sequence.frame_count() + kMostFrames - 1) / kMostFrames);
  for (std::int64_t i = 0; i < sequence.frame_count(); i += stride) {
    const Result<Rigid3> pose = true_pose(sequence, sequence.timestamp_s(i), "seen surface");
    if (!pose.ok()) continue;
    Result<dataset::RecordedFrame> recorded = sequence.read(i);
    if (!recorded.ok()) continue;
    const Result<frame::RgbdFrame> frame = dataset::decode_frame(std::move(*recorded));
    if (frame.ok()) append_seen(*frame, sequence.camera(), *pose, surface);
  }
  return surface;
}

Image<DrawnPixel> draw(const SeenSurface& surface, const Camera& camera,
                       const Image<std::uint8_t>& is_asked) {
  Image<DrawnPixel> drawn(camera.width, camera.height);
  const Box box = box_of(is_asked);
  std::vector<Projected> projected(surface.points.size());
  for (std::size_t i = 0; i < projected.size(); ++i)
    if (const Vector3d& point = surface.points[i].position_m; point.z() > kNearestDrawn_m)
      projected[i] = {pixel_of(camera, point), 1 / point.z()};
  for (const auto& [a, b, c] : surface.triangles) {
    const Projected &pa = projected[a], &pb = projected[b], &pc = projected[c];
    if (pa.inverse_depth == 0 || pb.inverse_depth == 0 || pc.inverse_depth == 0) continue;
    const Vector2d low = pa.at_px.cwiseMin(pb.at_px).cwiseMin(pc.at_px),
                   high = pa.at_px.cwiseMax(pb.at_px).cwiseMax(pc.at_px);
    if (high.x() < box.left || low.x() > box.right || high.y() < box.top || low.y() > box.bottom)
      continue;
    const double area = cross(pb.at_px - pa.at_px, pc.at_px - pa.at_px);
    if (area == 0) continue;
    const int left = std::max(box.left, static_cast<int>(std::ceil(low.x()))),
              right = std::min(box.right, static_cast<int>(high.x()));
    const int top = std::max(box.top, static_cast<int>(std::ceil(low.y()))),
              bottom = std::min(box.bottom, static_cast<int>(high.y()));
    for (int y = top; y <= bottom; ++y)
      for (int x = left; x <= right; ++x) {
        const Vector2d here(x, y);
        const double share_a = cross(pb.at_px - here, pc.at_px - here) / area,
                     share_b = cross(pc.at_px - here, pa.at_px - here) / area;
        const double share_c = 1 - share_a - share_b;
        if (share_a < 0 || share_b < 0 || share_c < 0 || !is_asked.at(x, y)) continue;
        // In the image, the inverse depth of a plane is linear.
        const double depth_m = 1 / (share_a * pa.inverse_depth + share_b * pb.inverse_depth +
                                    share_c * pc.inverse_depth);
        DrawnPixel& pixel = drawn.at(x, y);
        if (pixel.depth_m > 0 && pixel.depth_m <= depth_m) continue;
        pixel = {depth_m, static_cast<float>(share_a) * surface.points[a].color +
                              static_cast<float>(share_b) * surface.points[b].color +
                              static_cast<float>(share_c) * surface.points[c].color};
      }
  }
  return drawn;
}

}  // namespace hermite::disturb
