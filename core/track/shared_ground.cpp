#include "core/track/shared_ground.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "core/frame/sensor_noise.h"
#include "core/track/seen_twice.h"

namespace hermite::track {

namespace {

// The motion between two views, then the camera's errors.
constexpr Eigen::Index kPairSize = 6 + kCameraDoubtCount;
using PairVector = Eigen::Matrix<double, kPairSize, 1>;
using PairMatrix = Eigen::Matrix<double, kPairSize, kPairSize>;
using PointByCamera = Eigen::Matrix<double, 3, kCameraDoubtCount>;

constexpr std::size_t kMostPixels = 2400;

// Distance up to which surfaces are the same: three times the noise of a Kinect (Nguyen, Izadi,
// Lovell 2012), plus errors of poses and of a bent camera.
constexpr double kSame_m = 0.03, kSameGrowth_per_m = 0.0114;
constexpr double kAlikeCosine = 0.8, kNearest_m = 0.05;

// Grid of pixels, this many each way, for the check whether views may have anything in common, and
// a margin beyond the image as a share of it.
constexpr int kLooks = 5;
constexpr double kLookMargin = 0.25;

// A quarter of what a view shows, and at least this many pixels; fewer say nothing about the
// camera.
constexpr std::size_t kLeastShare = 4, kLeastMeetings = 100;
constexpr double kDegreesOfFreedom = 5;  // of Student's t distribution, as in the odometry
constexpr double kRobustSigmas = 2;      // its scale, wide enough for the effect of a bent camera

double variance_m2(double z) {
  const double deviation_m = frame::model_deviation_m({}, z);
  return deviation_m * deviation_m;
}

// If the stated focal length or distortion is too large, points are too close to the optical axis.
PointByCamera off_by_camera(const frame::CoarseView& view, int x, int y) {
  const Eigen::Vector3d point = view.point(x, y);
  PointByCamera off;
  off.col(kBendDoubt) = point * squared_image_distance(view.camera, x, y);
  off.col(kFocalDoubt) = Eigen::Vector3d(-point.x(), -point.y(), 0);
  off.col(kRadialDoubt) = off.col(kFocalDoubt) * (point / point.z()).head<2>().squaredNorm();
  return off;
}

frame::CoarseView half_of(const frame::CoarseView& view) {
  const shared::Intrinsics& whole = view.camera;
  frame::CoarseView half;
  half.camera = {whole.fx / 2, whole.fy / 2,          whole.cx / 2,
                 whole.cy / 2, (whole.width + 1) / 2, (whole.height + 1) / 2};
  for (int y = 0; y < static_cast<int>(whole.height); y += 2)
    for (int x = 0; x < static_cast<int>(whole.width); x += 2) {
      half.depth_m.push_back(view.depth_m[view.index(x, y)]);
      half.normals.push_back(view.normals[view.index(x, y)]);
    }
  return half;
}

}  // namespace

frame::CoarseView thinned(const frame::CoarseView& view, const frame::CoarseMask& moving) {
  frame::CoarseView result = view;
  for (std::size_t i = 0; i < moving.size(); ++i)
    if (moving[i] != 0) result.depth_m[i] = 0;
  while (result.size() > kMostPixels) result = half_of(result);
  result.grey.assign(result.size(), 0);
  return result;
}

SharedGround::SharedGround(const frame::CoarseView& view, const Rigid3& world_from_view,
                           const frame::CoarseView& other, const Rigid3& world_from_other)
    : view_(view),
      other_(other),
      world_from_view_(world_from_view.rotation.toRotationMatrix()),
      world_from_other_(world_from_other.rotation.toRotationMatrix()),
      other_from_view_(world_from_other_.transpose() * world_from_view_),
      view_in_world_m_(world_from_view.translation),
      view_in_other_m_(inverse(world_from_other) * world_from_view.translation) {}

bool SharedGround::may_meet() const {
  const int width = static_cast<int>(view_.camera.width),
            height = static_cast<int>(view_.camera.height);
  for (int row = 0; row < kLooks; ++row)
    for (int column = 0; column < kLooks; ++column) {
      const int x = (width - 1) * column / (kLooks - 1), y = (height - 1) * row / (kLooks - 1);
      const double depth_m = view_.depth_m[view_.index(x, y)];
      if (depth_m <= 0) return true;  // no depth, cannot be excluded
      const Eigen::Vector3d in_other = other_from_view_ * view_.point(x, y) + view_in_other_m_;
      if (in_other.z() < kNearest_m) continue;
      const Eigen::Vector2d uv = other_.project(in_other);
      const double margin_x = kLookMargin * other_.camera.width,
                   margin_y = kLookMargin * other_.camera.height;
      if (uv.x() > -margin_x && uv.y() > -margin_y && uv.x() < other_.camera.width + margin_x &&
          uv.y() < other_.camera.height + margin_y)
        return true;
    }
  return false;
}

bool SharedGround::meet(int x, int y, GroundMeeting& meeting) const {
  const Eigen::Vector3d in_view = view_.point(x, y),
                        in_other = other_from_view_ * in_view + view_in_other_m_;
  if (in_other.z() < kNearest_m) return false;
  const Eigen::Vector2d uv = other_.project(in_other);
  const int u = static_cast<int>(std::lround(uv.x())), v = static_cast<int>(std::lround(uv.y()));
  if (!other_.contains(u, v)) return false;
  const std::size_t i = other_.index(u, v);
  const double z = other_.depth_m[i];
  if (z <= 0) return false;
  const Eigen::Vector3d normal = other_.normals[i].cast<double>();
  meeting.distance_m = normal.dot(in_other - other_.point(u, v));
  if (std::abs(meeting.distance_m) > kSame_m + kSameGrowth_per_m * z * z) return false;
  meeting.normal = world_from_other_ * normal;
  meeting.own_normal = world_from_view_ * view_.normals[view_.index(x, y)].cast<double>();
  if (meeting.own_normal.dot(meeting.normal) < kAlikeCosine) return false;
  meeting.point = world_from_view_ * in_view + view_in_world_m_;
  meeting.off_by_camera = world_from_view_ * off_by_camera(view_, x, y) -
                          world_from_other_ * off_by_camera(other_, u, v);
  meeting.weight = 1 / (variance_m2(z) + variance_m2(in_other.z()));
  return true;
}

Eigen::Matrix<double, 3, 6> moved_by_twist(const Eigen::Vector3d& point_world) {
  Eigen::Matrix<double, 3, 6> moved;
  moved << Eigen::Matrix3d::Identity(), -skew(point_world);
  return moved;
}

// Distances are along the other view's normals, derivatives along the view's own: common noise
// would make the camera appear better than it is (errors in variables, as in
// core/calibrate/joint_adjustment.h). Without this, 0.6 of 1.5 % of bend is found.
CameraTerms camera_terms(const SharedGround& pair) {
  const frame::CoarseView& view = pair.view();
  // First the motion between both, then the camera.
  PairMatrix slope = PairMatrix::Zero(), information = PairMatrix::Zero();
  PairVector gradient = PairVector::Zero();
  std::size_t met = 0, surface = 0;
  for (int y = 0; y < static_cast<int>(view.camera.height); ++y)
    for (int x = 0; x < static_cast<int>(view.camera.width); ++x) {
      if (view.depth_m[view.index(x, y)] <= 0) continue;
      ++surface;
      GroundMeeting meeting;
      if (!pair.meet(x, y, meeting)) continue;
      ++met;
      Eigen::Matrix<double, 3, kPairSize> moved;
      moved << moved_by_twist(meeting.point), meeting.off_by_camera;
      const PairVector row = moved.transpose() * meeting.normal,
                       own = moved.transpose() * meeting.own_normal;
      const double scaled2 = meeting.distance_m * meeting.distance_m * meeting.weight /
                             (kRobustSigmas * kRobustSigmas);
      const double weight = meeting.weight * kDegreesOfFreedom / (kDegreesOfFreedom + scaled2);
      slope += weight * own * row.transpose();
      information += weight * own * own.transpose();
      gradient += weight * meeting.distance_m * own;
    }
  if (kLeastShare * met < surface || met < kLeastMeetings) return {};
  const Eigen::FullPivLU<Matrix6d> of_motion(slope.topLeftCorner<6, 6>().transpose());
  if (!of_motion.isInvertible()) return {};
  Eigen::Matrix<double, kCameraDoubtCount, kPairSize> whatever_the_motion;
  whatever_the_motion
      << -of_motion.solve(slope.bottomLeftCorner<kCameraDoubtCount, 6>().transpose()).transpose(),
      CameraDoubtMatrix::Identity();
  return {whatever_the_motion * slope.rightCols<kCameraDoubtCount>(),
          whatever_the_motion * information * whatever_the_motion.transpose(),
          whatever_the_motion * gradient};
}

}  // namespace hermite::track
