// Two views of the same ground: where they meet, and what that says of the camera's calibration. Pure functions, host only, any thread.
#pragma once

#include <Eigen/Core>

#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"

namespace hermite {

// A view without the pixels that move, and of so few that it can be kept: 40x30 of a frame of 640x480. Without grey values.
CoarseView thinned(const CoarseView& view, const CoarseMask& moving);

// What may be wrong with a camera: depth in the corners of the image is too great by `bend`, falling with the square of the distance from
// the middle; the focal length that it is said to have is too great by `focal`. Shares, in this order.
enum CameraDoubt : Eigen::Index { kBendDoubt, kFocalDoubt, kCameraDoubtCount };

// A point of one view on the surface of another, in the world. The normals are unit, away from the cameras.
struct GroundMeeting {
  Eigen::Vector3d point, normal, own_normal;                  // `normal` of the other view
  double distance_m = 0;                                      // of the point from the other's surface, along its normal
  double weight = 0;                                          // one over the variance of both measurements [1/m^2]
  Eigen::Matrix<double, 3, kCameraDoubtCount> off_by_camera;  // of the point less the other's, by what is wrong with the camera [m]
};

// Two views and where they are. Holds references to both.
class SharedGround {
 public:
  SharedGround(const CoarseView& view, const Rigid3& world_from_view, const CoarseView& other, const Rigid3& world_from_other);

  // Whether anything of the view may fall into the other's image: a quick look at a few pixels.
  bool may_meet() const;

  // Where a pixel of the view, which has a surface, meets the other's. False: it does not lie on the same ground.
  bool meet(int x, int y, GroundMeeting& meeting) const;

  const CoarseView& view() const { return view_; }

 private:
  const CoarseView& view_;
  const CoarseView& other_;
  const Eigen::Matrix3d world_from_view_, world_from_other_, other_from_view_;  // rotations
  const Eigen::Vector3d view_in_world_m_, view_in_other_m_;                     // positions
};

// What a twist about the world's origin moves a point by.
Eigen::Matrix<double, 3, 6> moved_by_twist(const Eigen::Vector3d& point_world);

// What the pair says of the camera c, whatever the motion between both: gradient = slope * c + noise, whose covariance is `information` if
// pixels are independent. All zero: too little in common.
struct CameraTerms {
  Eigen::Matrix2d slope = Eigen::Matrix2d::Zero(), information = Eigen::Matrix2d::Zero();
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
};
CameraTerms camera_terms(const SharedGround& pair);

}  // namespace hermite
