#include "core/track/landmarks.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace hermite {

namespace {

// As many landmarks as an image of the usual size has cells.
constexpr int kCell_px = 16;

// A corner is where the motion of the camera puts it, within this.
constexpr double kAgrees_px = 2;

// Depth measured again is another surface's beyond so many deviations. Measurements of the same corner share what the sensor has against
// it: ten of them do not tell more than this.
constexpr double kOtherSurface = 4, kLeastShareOfNoise = 0.3;

// Depth at a corner is that of one side of an edge or the other: beside the sensor's noise it is off by this much of its distance.
constexpr double kEdgeShare = 0.005;

// Two directions cross well enough when their depth is known to a tenth, and to seven tenths of that when they have to cross there again; a
// direction is known to half a pixel.
constexpr double kDirection_px = 0.5, kCrossed = 0.1, kFartherApart = 0.7;
constexpr double kNearest_m = 0.1, kFarthest_m = 20;

double noise_m(const FrameOptions& options, double depth_m) {
  const double beyond_m = std::max(0.0, depth_m - 0.4);
  return options.noise_floor_m + options.noise_growth_per_m * beyond_m * beyond_m + kEdgeShare * depth_m;
}

std::pair<int, int> cell_of(const Eigen::Vector2d& pixel) {
  return {static_cast<int>(pixel.x()) / kCell_px, static_cast<int>(pixel.y()) / kCell_px};
}

}  // namespace

Eigen::Vector2d Landmarks::image_px(const Eigen::Vector2d& level_px) const { return ((level_px.array() + 0.5) * image_px_ - 0.5).matrix(); }

std::optional<FeatureMotion> Landmarks::follow(const PictureFeatures& last, const PictureFeatures& frame,
                                               const std::function<bool(const Eigen::Vector2d&)>& is_left_out) {
  found_.assign(landmarks_.size(), std::nullopt);
  if (last.levels.size() != frame.levels.size() || last.levels.empty()) return std::nullopt;
  std::vector<FollowedCorner> all, with_depth;
  for (std::size_t i = 0; i < landmarks_.size(); ++i) {
    const Landmark& landmark = landmarks_[i];
    found_[i] = hermite::follow(last, frame, landmark.pixel);
    if (!found_[i] || is_left_out(*found_[i])) continue;
    if (const auto as_at_first = find_patch(landmark.patch, frame.levels[0], *found_[i])) found_[i] = as_at_first;
    all.push_back({landmark.point_m, image_px(*found_[i])});
    if (landmark.depth_deviation_m > 0) with_depth.push_back(all.back());
  }
  return motion_by_corners(all, with_depth, landmarks_.size(), camera_);
}

void Landmarks::measure(Landmark& landmark, double depth_m) const {
  const double noise = noise_m(options_, depth_m), known = landmark.depth_deviation_m;
  const double difference_m = depth_m - landmark.point_m.z();
  if (known == 0 || std::abs(difference_m) > kOtherSurface * (noise + known)) {
    landmark.point_m *= depth_m / landmark.point_m.z();
    landmark.depth_deviation_m = noise;
    return;
  }
  const double gain = known * known / (known * known + noise * noise);
  landmark.point_m *= 1 + gain * difference_m / landmark.point_m.z();
  landmark.depth_deviation_m = std::max(std::sqrt(1 - gain) * known, kLeastShareOfNoise * noise);
}

// From where it was seen at first and from here. What slides along an edge crosses somewhere, too, but elsewhere when the directions are
// farther apart.
void Landmarks::triangulate(Landmark& landmark) const {
  const Eigen::Vector3d now = landmark.point_m / landmark.point_m.z(), &first = landmark.first_direction;
  const Eigen::Vector3d across = now.cross(first);
  const double sine2 = across.squaredNorm() / (now.squaredNorm() * first.squaredNorm());
  const double depth_m = landmark.first_place_m.cross(first).dot(across) / across.squaredNorm();
  // A direction that is off by an angle moves the crossing by that over the angle between both.
  const double share = kDirection_px / camera_.fx / std::sqrt(std::max(sine2, 1e-12));
  if (share > kCrossed || !(depth_m > kNearest_m) || depth_m > kFarthest_m) return;
  if (landmark.crossed_share > 0 && share > kFartherApart * landmark.crossed_share) return;
  const double at = first.dot(depth_m * now - landmark.first_place_m) / first.squaredNorm();
  const bool is_again = std::abs(at - landmark.crossed_at) < 2 * landmark.crossed_share * at;
  landmark.crossed_at = at;
  landmark.crossed_share = share;
  if (!is_again) return;
  landmark.point_m = depth_m * now;
  landmark.depth_deviation_m = share * depth_m;
}

// Into the frame that was followed last, where it is at `pixel`. No: it is not there.
bool Landmarks::carry(Landmark& landmark, const Eigen::Vector2d& pixel, const DepthImage& depth, const Rigid3& camera_from_last) const {
  const Eigen::Vector2d in_image = image_px(pixel);
  landmark.first_place_m = camera_from_last * landmark.first_place_m;
  landmark.first_direction = camera_from_last.rotation * landmark.first_direction;
  landmark.pixel = pixel;
  if (landmark.depth_deviation_m > 0) {
    landmark.point_m = camera_from_last * landmark.point_m;
    if (landmark.point_m.z() < kNearest_m || (camera_.project(landmark.point_m) - in_image).norm() > kAgrees_px) return false;
  } else {
    landmark.point_m = camera_.unproject(in_image.x(), in_image.y(), 1);
  }
  const float measured_m = depth_around(depth, static_cast<int>(std::lround(in_image.x())), static_cast<int>(std::lround(in_image.y())),
                                        camera_.depth_units_per_metre, options_);
  if (measured_m > 0)
    measure(landmark, double{measured_m});
  else if (landmark.depth_deviation_m == 0)
    triangulate(landmark);
  return true;
}

Landmark Landmarks::seen_first(const Corner& corner, const GreyImage& image) const {
  Landmark landmark;
  landmark.pixel = {corner.x, corner.y};
  const Eigen::Vector2d in_image = image_px(landmark.pixel);
  landmark.first_direction = landmark.point_m = camera_.unproject(in_image.x(), in_image.y(), 1);
  landmark.patch = patch_around(image, corner);
  if (corner.depth_m > 0) measure(landmark, double{corner.depth_m});
  return landmark;
}

void Landmarks::remember(const PictureFeatures& frame, const DepthImage& depth, const Rigid3& last_from_camera,
                         const std::function<bool(const Eigen::Vector2d&)>& moves) {
  const Rigid3 camera_from_last = inverse(last_from_camera);
  std::vector<Landmark> kept;
  std::set<std::pair<int, int>> taken;
  image_px_ = frame.image_px;
  for (std::size_t i = 0; i < found_.size(); ++i) {
    if (!found_[i] || moves(*found_[i]) || !carry(landmarks_[i], *found_[i], depth, camera_from_last)) continue;
    if (!taken.insert(cell_of(*found_[i])).second) continue;  // two in a cell are one too many
    kept.push_back(std::move(landmarks_[i]));
  }
  for (const Corner& corner : frame.corners)
    if (const Eigen::Vector2d pixel(corner.x, corner.y); !moves(pixel) && taken.insert(cell_of(pixel)).second)
      kept.push_back(seen_first(corner, frame.levels[0]));
  landmarks_ = std::move(kept);
  found_.clear();
}

void Landmarks::forget() {
  landmarks_.clear();
  found_.clear();
}

namespace {

template <class Bytes, class Vector>
void vector_fields(Bytes& bytes, Vector& vector) {
  for (auto& number : vector) bytes.number(number);
}

template <class Bytes, class Place>
void fields(Bytes& bytes, Place& landmark) {
  vector_fields(bytes, landmark.pixel);
  vector_fields(bytes, landmark.point_m);
  bytes.number(landmark.depth_deviation_m);
  vector_fields(bytes, landmark.first_place_m);
  vector_fields(bytes, landmark.first_direction);
  bytes.number(landmark.crossed_at);
  bytes.number(landmark.crossed_share);
  bytes.number(landmark.patch.width);
  bytes.number(landmark.patch.height);
  bytes.numbers(landmark.patch.pixels);
}

// What it may have been: no pixel outside, no depth that a camera has not.
bool is_possible(const Landmark& landmark, const GreyImage& image) {
  const GreyImage& patch = landmark.patch;
  const bool is_patch =
      patch.pixels.empty() || (patch.width == patch.height && patch.width == patch_side_px() &&
                               patch.pixels.size() == static_cast<std::size_t>(patch.width) * static_cast<std::size_t>(patch.width));
  return is_patch && landmark.pixel.x() >= 0 && landmark.pixel.y() >= 0 && landmark.pixel.x() < image.width &&
         landmark.pixel.y() < image.height && landmark.point_m.allFinite() && landmark.point_m.z() > 0 && landmark.depth_deviation_m >= 0 &&
         std::isfinite(landmark.depth_deviation_m) && landmark.first_place_m.allFinite() && landmark.first_direction.allFinite() &&
         std::isfinite(landmark.crossed_at) && std::isfinite(landmark.crossed_share);
}

}  // namespace

void Landmarks::save(ByteWriter& bytes) const {
  bytes.number(image_px_);
  bytes.list(landmarks_, [](ByteWriter& to, const Landmark& landmark) { fields(to, landmark); });
}

void Landmarks::restore(ByteReader& bytes, const PictureFeatures& last) {
  bytes.number(image_px_);
  bytes.list(landmarks_, [](ByteReader& from, Landmark& landmark) { fields(from, landmark); });
  const auto fits = [&last](const Landmark& landmark) { return !last.levels.empty() && is_possible(landmark, last.levels[0]); };
  bytes.require(std::all_of(landmarks_.begin(), landmarks_.end(), fits) && (image_px_ == 1 || image_px_ == 2),
                "the landmarks of the last picture");
  found_.clear();
}

}  // namespace hermite
