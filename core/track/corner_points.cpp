#include "core/track/corner_points.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "core/base/frame_helpers.h"
#include "core/frame/sensor_noise.h"

namespace hermite::track {

namespace {

// Size of a grid cell; at most one point is kept per cell.
constexpr int kCell_px = 16;

// A corner is consistent with the camera's motion if its reprojection error is at most this.
constexpr double kAgrees_px = 2;

// A depth that differs by more than this many standard deviations belongs to another surface.
// Measurements of the same corner share the sensor's systematic error, so their mean is never taken
// to be better than this share of the noise of one measurement, which about ten measurements reach.
constexpr double kOtherSurface = 4, kLeastShareOfNoise = 0.3;

// The depth at a corner is that of one side of an edge or the other; in addition to the sensor's
// noise it is off by this share of the distance.
constexpr double kEdgeShare = 0.005;

// A viewing direction is known to half a pixel. The intersection of two directions counts once its
// relative deviation is at most a tenth, and it is confirmed by an intersection whose deviation is
// at most seven tenths of the first one's.
constexpr double kDirection_px = 0.5, kCrossed = 0.1, kFartherApart = 0.7;
constexpr double kNearest_m = 0.1, kFarthest_m = 20;

double noise_m(const frame::FrameOptions& options, double depth_m) {
  return frame::model_deviation_m(options, depth_m) + kEdgeShare * depth_m;
}

std::pair<int, int> cell_of(const Eigen::Vector2d& pixel) {
  return {static_cast<int>(pixel.x()) / kCell_px, static_cast<int>(pixel.y()) / kCell_px};
}

}  // namespace

Eigen::Vector2d CornerPoints::image_px(const Eigen::Vector2d& level_px) const {
  return ((level_px.array() + 0.5) * image_px_ - 0.5).matrix();
}

std::optional<FeatureMotion> CornerPoints::follow(
    const frame::ImageFeatures& last, const frame::ImageFeatures& frame,
    const std::function<bool(const Eigen::Vector2d&)>& is_left_out) {
  found_.assign(points_.size(), std::nullopt);
  if (last.levels.size() != frame.levels.size() || last.levels.empty()) return std::nullopt;
  std::vector<std::uint8_t> is_used(points_.size(), 0);
  in_parallel_of_frame(points_.size(), [&](std::size_t i) {
    found_[i] = track::follow(last, frame, points_[i].pixel);
    if (!found_[i] || is_left_out(*found_[i])) return;
    if (const auto as_at_first = find_patch(points_[i].patch, frame.levels[0], *found_[i]))
      found_[i] = as_at_first;
    is_used[i] = 1;
  });
  std::vector<FollowedCorner> all, with_depth;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    if (is_used[i] == 0) continue;
    all.push_back({points_[i].point_m, image_px(*found_[i])});
    if (points_[i].depth_deviation_m > 0) with_depth.push_back(all.back());
  }
  return motion_by_corners(all, with_depth, points_.size(), camera_);
}

void CornerPoints::measure(CornerPoint& point, double depth_m) const {
  const double noise = noise_m(options_, depth_m), known = point.depth_deviation_m;
  const double difference_m = depth_m - point.point_m.z();
  if (known == 0 || std::abs(difference_m) > kOtherSurface * (noise + known)) {
    point.point_m *= depth_m / point.point_m.z();
    point.depth_deviation_m = noise;
    return;
  }
  const double gain = known * known / (known * known + noise * noise);
  point.point_m *= 1 + gain * difference_m / point.point_m.z();
  point.depth_deviation_m = std::max(std::sqrt(1 - gain) * known, kLeastShareOfNoise * noise);
}

// Triangulates from the first and the present viewing direction. A corner that slides along an edge
// gives an intersection too, but another one when the angle between the directions has grown; hence
// two must agree.
void CornerPoints::triangulate(CornerPoint& point) const {
  const Eigen::Vector3d now = point.point_m / point.point_m.z(), &first = point.first_direction;
  const Eigen::Vector3d across = now.cross(first);
  const double sine2 = across.squaredNorm() / (now.squaredNorm() * first.squaredNorm());
  const double depth_m = point.first_place_m.cross(first).dot(across) / across.squaredNorm();
  // The relative error of the depth is the angular error over the angle between the two directions.
  const double share = kDirection_px / camera_.fx / std::sqrt(std::max(sine2, 1e-12));
  if (share > kCrossed || !(depth_m > kNearest_m) || depth_m > kFarthest_m) return;
  if (point.crossed_share > 0 && share > kFartherApart * point.crossed_share) return;
  const double at = first.dot(depth_m * now - point.first_place_m) / first.squaredNorm();
  const bool is_again = std::abs(at - point.crossed_at) < 2 * point.crossed_share * at;
  point.crossed_at = at;
  point.crossed_share = share;
  if (!is_again) return;
  point.point_m = depth_m * now;
  point.depth_deviation_m = share * depth_m;
}

// Moves the point into the frame that was last followed, where it was found at `pixel`. Returns
// false if that contradicts the camera's motion.
bool CornerPoints::carry(CornerPoint& point, const Eigen::Vector2d& pixel, const DepthImage& depth,
                         const Rigid3& camera_from_last) const {
  const Eigen::Vector2d in_image = image_px(pixel);
  point.first_place_m = camera_from_last * point.first_place_m;
  point.first_direction = camera_from_last.rotation * point.first_direction;
  point.pixel = pixel;
  if (point.depth_deviation_m > 0) {
    point.point_m = camera_from_last * point.point_m;
    if (point.point_m.z() < kNearest_m ||
        (camera_.project(point.point_m) - in_image).norm() > kAgrees_px)
      return false;
  } else {
    point.point_m = camera_.unproject(in_image.x(), in_image.y(), 1);
  }
  const float measured_m = frame::depth_around(depth, static_cast<int>(std::lround(in_image.x())),
                                               static_cast<int>(std::lround(in_image.y())),
                                               camera_.depth_units_per_metre, options_);
  if (measured_m > 0)
    measure(point, double{measured_m});
  else if (point.depth_deviation_m == 0)
    triangulate(point);
  return true;
}

CornerPoint CornerPoints::seen_first(const frame::Corner& corner,
                                     const frame::GreyImage& image) const {
  CornerPoint point;
  point.pixel = {corner.x, corner.y};
  const Eigen::Vector2d in_image = image_px(point.pixel);
  point.first_direction = point.point_m = camera_.unproject(in_image.x(), in_image.y(), 1);
  point.patch = patch_around(image, corner);
  if (corner.depth_m > 0) measure(point, double{corner.depth_m});
  return point;
}

void CornerPoints::remember(const frame::ImageFeatures& frame, const DepthImage& depth,
                            const Rigid3& last_from_camera,
                            const std::function<bool(const Eigen::Vector2d&)>& moves) {
  const Rigid3 camera_from_last = inverse(last_from_camera);
  std::vector<CornerPoint> kept;
  std::set<std::pair<int, int>> taken;
  image_px_ = frame.image_px;
  for (std::size_t i = 0; i < found_.size(); ++i) {
    if (!found_[i] || moves(*found_[i]) || !carry(points_[i], *found_[i], depth, camera_from_last))
      continue;
    if (!taken.insert(cell_of(*found_[i])).second) continue;  // only one point per cell
    kept.push_back(std::move(points_[i]));
  }
  for (const frame::Corner& corner : frame.corners)
    if (const Eigen::Vector2d pixel(corner.x, corner.y);
        !moves(pixel) && taken.insert(cell_of(pixel)).second)
      kept.push_back(seen_first(corner, frame.levels[0]));
  points_ = std::move(kept);
  found_.clear();
}

void CornerPoints::forget() {
  points_.clear();
  found_.clear();
}

namespace {

template <class Bytes, class Vector>
void vector_fields(Bytes& bytes, Vector& vector) {
  for (auto& number : vector) bytes.number(number);
}

template <class Bytes, class Place>
void fields(Bytes& bytes, Place& point) {
  vector_fields(bytes, point.pixel);
  vector_fields(bytes, point.point_m);
  bytes.number(point.depth_deviation_m);
  vector_fields(bytes, point.first_place_m);
  vector_fields(bytes, point.first_direction);
  bytes.number(point.crossed_at);
  bytes.number(point.crossed_share);
  bytes.number(point.patch.width);
  bytes.number(point.patch.height);
  bytes.numbers(point.patch.pixels);
}

// Validates a restored point: its patch has the expected size, its pixel is in the image and its
// depth is plausible.
bool is_possible(const CornerPoint& point, const frame::GreyImage& image) {
  const frame::GreyImage& patch = point.patch;
  const bool is_patch =
      patch.pixels.empty() || (patch.width == patch.height && patch.width == patch_side_px() &&
                               patch.pixels.size() == static_cast<std::size_t>(patch.width) *
                                                          static_cast<std::size_t>(patch.width));
  return is_patch && point.pixel.x() >= 0 && point.pixel.y() >= 0 &&
         point.pixel.x() < image.width && point.pixel.y() < image.height &&
         point.point_m.allFinite() && point.point_m.z() > 0 && point.depth_deviation_m >= 0 &&
         std::isfinite(point.depth_deviation_m) && point.first_place_m.allFinite() &&
         point.first_direction.allFinite() && std::isfinite(point.crossed_at) &&
         std::isfinite(point.crossed_share);
}

}  // namespace

void CornerPoints::save(ByteWriter& bytes) const {
  bytes.number(image_px_);
  bytes.list(points_, [](ByteWriter& to, const CornerPoint& point) { fields(to, point); });
}

void CornerPoints::restore(ByteReader& bytes, const frame::ImageFeatures& last) {
  bytes.number(image_px_);
  bytes.list(points_, [](ByteReader& from, CornerPoint& point) { fields(from, point); });
  const auto fits = [&last](const CornerPoint& point) {
    return !last.levels.empty() && is_possible(point, last.levels[0]);
  };
  bytes.require(
      std::all_of(points_.begin(), points_.end(), fits) && (image_px_ == 1 || image_px_ == 2),
      "the points of the last picture");
  found_.clear();
}

}  // namespace hermite::track
