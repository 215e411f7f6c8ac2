#include "core/evaluate/true_points.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/dataset/associate.h"
#include "core/math/counted_random.h"
#include "core/math/principal_axes.h"

namespace hermite::evaluate {

namespace {

using Eigen::Vector3d;

constexpr std::int64_t kMostViews = 120;
constexpr double kNearestTruth_m = 0.4, kFarthestTruth_m = 4.5;
constexpr double kSameDepth_m = 0.01, kSameDepthShare = 0.01;

// Limits for planes: depth is rounded to 0.2 mm or more.
constexpr double kOnPlane_m = 0.0015, kBesidePlane_m = 0.0045, kMostBesideShare = 0.2,
                 kLeastBreadth_m = 0.04;
constexpr std::size_t kLeastPixels = 400;
constexpr int kSeedRadius_px = 4, kPlaneRounds = 3;

// A plane through points, facing `towards`, with the standard deviation of the points across their
// longest direction.
struct FittedPlane {
  Vector3d centre_m, normal;
  double breadth_m = 0;
};

FittedPlane plane_through(const std::vector<Vector3d>& points, const Vector3d& towards) {
  const PrincipalAxes axes = principal_axes(points);
  return {axes.centre, facing(axes.direction[2], towards - axes.centre), axes.deviation[1]};
}

}  // namespace

Result<TruePlaces> TruePlaces::of(const dataset::Sequence& sequence,
                                  const dataset::Trajectory& estimate) {
  if (sequence.groundtruth().empty())
    return Error{ErrorCode::kNotFound, sequence.name() + " has no true poses"};
  TruePlaces surface(sequence.camera());
  const std::int64_t stride =
      std::max<std::int64_t>(1, (sequence.frame_count() + kMostViews - 1) / kMostViews);
  for (std::int64_t i = 0; i < sequence.frame_count(); i += stride) {
    const auto truth = dataset::pose_at(sequence.groundtruth(), sequence.timestamp_s(i),
                                        dataset::kMaxAssociationGap_s);
    const auto found =
        dataset::pose_at(estimate, sequence.timestamp_s(i), dataset::kMaxAssociationGap_s);
    Result<dataset::RecordedFrame> frame = sequence.read(i);
    if (truth && found && frame.ok())
      surface.views_.push_back({std::move(frame->depth), *truth, *found});
  }
  if (surface.views_.empty())
    return Error{ErrorCode::kNotFound,
                 "the trajectory has no pose at the time of a frame of " + sequence.name()};
  return surface;
}

double TruePlaces::depth_m(const TruePixel& pixel) const {
  return views_[pixel.view].depth.at(pixel.x, pixel.y) / camera_.depth_units_per_metre;
}

Vector3d TruePlaces::true_m(const TruePixel& pixel) const {
  return views_[pixel.view].true_from_camera * camera_.unproject(pixel.x, pixel.y, depth_m(pixel));
}

bool TruePlaces::sees(const View& view, const Vector3d& in_camera) const {
  if (in_camera.z() < kNearestTruth_m) return false;
  const double x = std::round(camera_.fx * in_camera.x() / in_camera.z() + camera_.cx);
  const double y = std::round(camera_.fy * in_camera.y() / in_camera.z() + camera_.cy);
  if (x < 0 || y < 0 || x >= camera_.width || y >= camera_.height) return false;
  const double there_m =
      view.depth.at(static_cast<int>(x), static_cast<int>(y)) / camera_.depth_units_per_metre;
  return std::abs(there_m - in_camera.z()) <= kSameDepth_m + kSameDepthShare * in_camera.z();
}

std::vector<TruePoint> TruePlaces::points(std::size_t count, std::uint64_t seed) const {
  std::vector<TruePoint> points;
  for (std::size_t i = 0; i < count; ++i) {
    const std::uint64_t key = frame_key(seed, static_cast<std::int64_t>(i));
    const auto below = [&](int limit, std::uint64_t counter) {
      return static_cast<int>(unit_uniform(key, counter) * limit);
    };
    const auto view = static_cast<std::size_t>(below(static_cast<int>(views_.size()), 0));
    if (const auto point = point_at({view, below(camera_.width, 1), below(camera_.height, 2)}))
      points.push_back(*point);
  }
  return points;
}

std::optional<TruePoint> TruePlaces::point_at(const TruePixel& pixel) const {
  if (depth_m(pixel) < kNearestTruth_m || depth_m(pixel) > kFarthestTruth_m) return std::nullopt;
  TruePoint point{pixel, true_m(pixel), Vector3d::Zero()};
  int seen = 0;
  for (const View& view : views_) {
    const Vector3d in_camera = inverse(view.true_from_camera) * point.true_m;
    if (!sees(view, in_camera)) continue;
    point.estimated_m += view.estimate_from_camera * in_camera;
    ++seen;
  }
  if (seen == 0) return std::nullopt;
  point.estimated_m /= seen;
  return point;
}

std::vector<TruePixel> TruePlaces::connected(const TruePixel& from, const TruePlane& plane,
                                             double within_m) const {
  std::vector<bool> reached(static_cast<std::size_t>(camera_.width) *
                            static_cast<std::size_t>(camera_.height));
  std::vector<TruePixel> pixels;
  const auto reach = [&](const TruePixel& pixel) {
    if (pixel.x < 0 || pixel.y < 0 || pixel.x >= camera_.width || pixel.y >= camera_.height) return;
    const std::size_t index =
        static_cast<std::size_t>(pixel.y) * static_cast<std::size_t>(camera_.width) +
        static_cast<std::size_t>(pixel.x);
    if (reached[index]) return;
    reached[index] = true;
    const double depth = depth_m(pixel);
    if (depth < kNearestTruth_m || depth > kFarthestTruth_m) return;
    if (std::abs(plane.normal.dot(true_m(pixel) - plane.centre_m)) <= within_m)
      pixels.push_back(pixel);
  };
  reach(from);
  for (std::size_t next = 0; next < pixels.size(); ++next) {
    const TruePixel here = pixels[next];
    for (const auto& [right, down] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}})
      reach({here.view, here.x + right, here.y + down});
  }
  return pixels;
}

std::optional<TruePlane> TruePlaces::plane_at(const TruePixel& pixel) const {
  const Vector3d camera_m = views_[pixel.view].true_from_camera.translation;
  TruePlane plane;
  for (int dy = -kSeedRadius_px; dy <= kSeedRadius_px; ++dy)
    for (int dx = -kSeedRadius_px; dx <= kSeedRadius_px; ++dx) {
      const TruePixel beside{pixel.view, pixel.x + dx, pixel.y + dy};
      if (beside.x < 0 || beside.y < 0 || beside.x >= camera_.width || beside.y >= camera_.height)
        return std::nullopt;
      if (std::abs(depth_m(beside) - depth_m(pixel)) < 0.1 * depth_m(pixel))
        plane.pixels.push_back(beside);
    }
  for (int round = 0; round <= kPlaneRounds; ++round) {
    if (plane.pixels.size() < 3) return std::nullopt;
    std::vector<Vector3d> points;
    for (const TruePixel& one : plane.pixels) points.push_back(true_m(one));
    const FittedPlane fitted = plane_through(points, camera_m);
    plane.centre_m = fitted.centre_m;
    plane.normal = fitted.normal;
    if (round < kPlaneRounds) plane.pixels = connected(pixel, plane, kOnPlane_m);
    const bool is_broad =
        plane.pixels.size() >= kLeastPixels && fitted.breadth_m >= kLeastBreadth_m;
    if (round == kPlaneRounds && !is_broad) return std::nullopt;
  }
  const auto beside = static_cast<double>(connected(pixel, plane, kBesidePlane_m).size());
  return beside > (1 + kMostBesideShare) * static_cast<double>(plane.pixels.size())
             ? std::nullopt
             : std::optional(plane);
}

Vector3d TruePlaces::true_up() const {
  const Vector3d up = -(views_.front().true_from_camera.rotation * Vector3d::UnitY());
  Eigen::Index axis = 0;
  up.cwiseAbs().maxCoeff(&axis);
  return Vector3d::Unit(axis) * (up[axis] < 0 ? -1 : 1);
}

Eigen::Quaterniond TruePlaces::estimate_from_true() const {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const View& view : views_)
    sum += (view.estimate_from_camera.rotation * view.true_from_camera.rotation.conjugate())
               .toRotationMatrix();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  return Eigen::Quaterniond(svd.matrixU() * svd.matrixV().transpose()).normalized();
}

}  // namespace hermite::evaluate
