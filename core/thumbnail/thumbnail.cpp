#include "core/thumbnail/thumbnail.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "core/image/image_codec.h"
#include "core/image/resize.h"
#include "core/output/spacing.h"
#include "core/thumbnail/disc_view.h"
#include "core/thumbnail/up_direction.h"

namespace hermite::thumbnail {

namespace {

// The darkest of the viewer's greys: an image is one tile on light and dark pages.
constexpr Rgb8 kBackground{22, 24, 29};
constexpr int kOversampling = 2;  // each way, so that edges are smooth
constexpr int kQuality = 85;      // of the JPEG
// 38 degrees: as in drawings of rooms, floor and walls are seen alike.
constexpr float kElevation_rad = 0.66f;
constexpr int kSides = 12;        // directions all around that are tried
constexpr float kMargin = 0.06f;  // of the image, on each side
// This share of the points on each side does not count for its size: what lies outside of a room.
constexpr double kStray = 0.001;
constexpr std::size_t kTriedPoints = 20'000;
constexpr int kTriedWidth_px = 96, kTriedHeight_px = 72;
// Discs are drawn larger than a surfel's, so that none of the background shines through.
constexpr float kOverlap = 1.2f;

Eigen::Matrix3f view_from_side(const Eigen::Vector3f& up, float turn_rad) {
  const Eigen::Vector3f ahead = (Eigen::Vector3f::UnitZ() - up * up.z()).normalized();
  const Eigen::Vector3f level = Eigen::AngleAxisf(turn_rad, up) * ahead;
  const Eigen::Vector3f away =
      (level * std::cos(kElevation_rad) - up * std::sin(kElevation_rad)).normalized();
  const Eigen::Vector3f right = away.cross(up).normalized();
  Eigen::Matrix3f view;
  view << right.transpose(), away.cross(right).transpose(), away.transpose();
  return view;
}

// The range that holds all but the stray values.
std::pair<float, float> range_of(std::vector<float>& values) {
  const auto stray = static_cast<std::ptrdiff_t>(kStray * static_cast<double>(values.size()));
  const auto low = values.begin() + stray, high = values.end() - 1 - stray;
  std::nth_element(values.begin(), low, values.end());
  const float least = *low;
  std::nth_element(values.begin(), high, values.end());
  return {least, *high};
}

ParallelView framed(const output::Cloud& cloud, const Eigen::Matrix3f& view_from_world,
                    int width_px, int height_px) {
  std::vector<float> x_m, y_m;
  for (const output::CloudPoint& point : cloud) {
    const Eigen::Vector3f at_m = view_from_world * point.position_m;
    x_m.push_back(at_m.x());
    y_m.push_back(at_m.y());
  }
  const auto [left_m, right_m] = range_of(x_m);
  const auto [top_m, bottom_m] = range_of(y_m);
  constexpr float kLeast_m = 0.05f;  // a single point is not enlarged without end
  const float inner = 1 - 2 * kMargin;
  ParallelView view;
  view.view_from_world = view_from_world;
  view.radius_scale = kOverlap;
  view.middle_m = {(left_m + right_m) / 2, (top_m + bottom_m) / 2};
  view.pixels_per_m =
      std::min(inner * static_cast<float>(width_px) / std::max(kLeast_m, right_m - left_m),
               inner * static_cast<float>(height_px) / std::max(kLeast_m, bottom_m - top_m));
  return view;
}

// Every so many of the points that can be drawn, each with the area of those that are left out.
output::Cloud some_of(const output::Cloud& cloud, std::size_t most) {
  const std::size_t step = std::max<std::size_t>(1, (cloud.size() + most - 1) / most);
  output::Cloud some;
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    if (!cloud[i].position_m.allFinite()) continue;
    some.push_back(cloud[i]);
    some.back().radius_m *= std::sqrt(static_cast<float>(step));
  }
  return some;
}

// The view from the side that shows most of the surface.
ParallelView best_view(const output::Cloud& cloud, const std::optional<UpDirection>& measured_up,
                       int width_px, int height_px) {
  const output::Cloud tried = some_of(cloud, kTriedPoints);
  ParallelView best;
  if (tried.empty()) return best;
  const Eigen::Vector3f up = best_up(tried, measured_up);
  double most_m2 = -1;
  for (int side = 0; side < kSides; ++side) {
    const float turn_rad = 2 * std::numbers::pi_v<float> * static_cast<float>(side) / kSides;
    const ParallelView view =
        framed(tried, view_from_side(up, turn_rad), kTriedWidth_px, kTriedHeight_px);
    const auto drawn_px = static_cast<double>(
        draw_discs(tried, view, kTriedWidth_px, kTriedHeight_px, kBackground).drawn_px);
    const double shown_m2 = drawn_px / (static_cast<double>(view.pixels_per_m) *
                                        static_cast<double>(view.pixels_per_m));
    if (shown_m2 <= most_m2) continue;
    most_m2 = shown_m2;
    best = framed(tried, view.view_from_world, width_px, height_px);
  }
  return best;
}

ColorImage drawn(const output::Cloud& cloud, const std::optional<UpDirection>& up) {
  constexpr int kWidth_px = kOversampling * kThumbnailWidth_px,
                kHeight_px = kOversampling * kThumbnailHeight_px;
  const DiscImage image = draw_discs(cloud, best_view(cloud, up, kWidth_px, kHeight_px), kWidth_px,
                                     kHeight_px, kBackground);
  return image::resize_color(image.color, {kThumbnailWidth_px, kThumbnailHeight_px});
}

}  // namespace

ColorImage thumbnail_of(const output::Cloud& cloud, const std::optional<UpDirection>& up) {
  if (std::any_of(cloud.begin(), cloud.end(),
                  [](const output::CloudPoint& point) { return point.radius_m > 0; }))
    return drawn(cloud, up);
  // Of another program's cloud: each point takes the place that its neighbours leave it.
  output::Cloud points;
  std::copy_if(cloud.begin(), cloud.end(), std::back_inserter(points),
               [](const output::CloudPoint& point) { return point.position_m.allFinite(); });
  const std::vector<float> spacings_m = output::point_spacings_m(points);
  for (std::size_t i = 0; i < points.size(); ++i) points[i].radius_m = spacings_m[i];
  return drawn(points, up);
}

Result<std::string> thumbnail_jpeg(const output::Cloud& cloud,
                                   const std::optional<UpDirection>& up) {
  const Result<std::vector<std::uint8_t>> bytes =
      image::encode_jpeg(thumbnail_of(cloud, up), kQuality);
  if (!bytes.ok()) return bytes.error();
  return std::string(bytes->begin(), bytes->end());
}

}  // namespace hermite::thumbnail
