// Relates two views of the same surface: where they meet, and what that says about the camera's
// calibration. Pure functions on the host. Any thread.
#pragma once

#include <Eigen/Core>

#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"

namespace hermite::track {

// Returns a view without moving pixels, reduced to few enough pixels to be kept: 40x30 for a frame
// of 640x480. It has no grey values.
frame::CoarseView thinned(const frame::CoarseView& view, const frame::CoarseMask& moving);

// Possible errors of a camera, the first two as shares, in this order: depth in the corners of the
// image is too large by `bend`, which falls with the square of the distance from the middle; the
// stated focal length is too large by `focal`; the stated distortion of the lens, k1, is too large
// by this number.
enum CameraDoubt : Eigen::Index { kBendDoubt, kFocalDoubt, kRadialDoubt, kCameraDoubtCount };
using CameraDoubts = Eigen::Matrix<double, kCameraDoubtCount, 1>;
using CameraDoubtMatrix = Eigen::Matrix<double, kCameraDoubtCount, kCameraDoubtCount>;

// A point of one view on the surface of another, in the world. The normals are unit vectors that
// point away from the cameras.
struct GroundMeeting {
  Eigen::Vector3d point, normal, own_normal;  // `normal` is that of the other view
  // Distance of the point from the other surface, along its normal.
  double distance_m = 0;
  // Inverse variance of both measurements [1/m^2].
  double weight = 0;
  // Derivative of the point minus the other's by the camera's errors [m].
  Eigen::Matrix<double, 3, kCameraDoubtCount> off_by_camera;
};

// Two views with their poses. Holds references to both views.
class SharedGround {
 public:
  SharedGround(const frame::CoarseView& view, const Rigid3& world_from_view,
               const frame::CoarseView& other, const Rigid3& world_from_other);

  // Returns whether anything of the view may project into the other's image, from a few pixels.
  bool may_meet() const;

  // Computes where a pixel of the view that has a surface meets the other's. Returns false if it is
  // not on the same surface.
  bool meet(int x, int y, GroundMeeting& meeting) const;

  const frame::CoarseView& view() const { return view_; }

 private:
  const frame::CoarseView& view_;
  const frame::CoarseView& other_;
  const Eigen::Matrix3d world_from_view_, world_from_other_, other_from_view_;  // rotations
  const Eigen::Vector3d view_in_world_m_, view_in_other_m_;                     // positions
};

// Returns the derivative of a point by a twist about the world's origin.
Eigen::Matrix<double, 3, 6> moved_by_twist(const Eigen::Vector3d& point_world);

// What the pair says about the camera errors c, whatever the motion between the views: gradient =
// slope * c + noise, whose covariance is `information` if pixels are independent. All zero if there
// is too little in common.
struct CameraTerms {
  CameraDoubtMatrix slope = CameraDoubtMatrix::Zero(), information = CameraDoubtMatrix::Zero();
  CameraDoubts gradient = CameraDoubts::Zero();
};
CameraTerms camera_terms(const SharedGround& pair);

// Saves or restores them.
template <class Bytes, class Terms>
void camera_terms_fields(Bytes& bytes, Terms& terms) {
  constexpr std::size_t kCount = kCameraDoubtCount;
  bytes.numbers(terms.slope.data(), kCount * kCount);
  bytes.numbers(terms.information.data(), kCount * kCount);
  bytes.numbers(terms.gradient.data(), kCount);
}

}  // namespace hermite::track
