// Corrects frames for the time at which their pixels were taken (Camera::timing), given the camera's velocity.
//
// The disturbances (core/dataset/moved_view.h) move pixels likewise, in double precision and until they settle. They stay
// apart from this, so that a correction is not tested against itself.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "core/base/image.h"
#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"

namespace hermite {

// Const functions are thread-safe.
class Retimer {
 public:
  // Frames are of rectified(camera), except for the timing. The rows of a rectified image are taken to be those of the
  // received one, from which they differ by some pixels of several hundred.
  explicit Retimer(const Camera& camera);

  // Returns the frame as the camera would have seen it in one instant, that of the time stamp, when it moves with this
  // twist per second in its own coordinate frame (translation part first). Objects are assumed not to move by
  // themselves. What the frame does not show, beyond its border and behind edges, has no depth, and colour repeats the
  // border; pixels without depth are taken to be infinitely far. The frame has the camera's size.
  RgbdFrame apply(const RgbdFrame& frame, const Vector6d& twist_per_s) const;

  // Returns how far apart apply() puts the surface with one twist and with the other, as the root mean square over the
  // image, depth or colour, that is farther in time; 0 without depth.
  double difference_m(const DepthImage& depth, const Vector6d& a_per_s, const Vector6d& b_per_s) const;

  // Returns the pixel of a point at the time stamp, which a rectified colour image shows at `pixel_px`; `point_m` is its
  // approximate position at the time stamp, in front of the camera.
  Eigen::Vector2d color_pixel_at_stamp(const Eigen::Vector2d& pixel_px, const Eigen::Vector3d& point_m, const Vector6d& twist_per_s) const;

 private:
  // Of the camera when a row is taken, from where it is at the time stamp.
  struct RowMotion {
    Eigen::Matrix3f rotation;
    Eigen::Vector3f translation_m;
  };
  std::vector<RowMotion> motions(const Vector6d& twist_per_s, double readout_s, double delay_s) const;
  Eigen::Vector3f ray(int x, int y) const;
  Eigen::Vector2f pixel_of(const Eigen::Vector3f& direction) const;
  float depth_between_m(const DepthImage& depth, const Eigen::Vector2f& at_px) const;
  float depth_m(const DepthImage& depth, int x, int y, const std::vector<RowMotion>& row_from_stamp) const;
  Rgb8 color(const RgbdFrame& frame, int x, int y, const std::vector<RowMotion>& row_from_stamp) const;

  const Camera camera_;
  const Eigen::Vector2f focal_px_, center_px_, last_px_;
  const float metres_per_depth_unit_;
};

// Returns nullopt for a camera that takes all pixels at the time stamp.
std::optional<Retimer> retimer_of(const Camera& camera);

}  // namespace hermite
