// The error to expect of a camera's whole path from the noise of its steps. It is an estimate and
// not a bound: without the systematic errors and the doubt about the camera's calibration that
// PoseUncertainty includes.
//
// Three things add to it. Frames are wrong relative to the surface that they are tracked against.
// Views that bring new surface hand their errors on (the Gaussian vector of
// core/track/map_certainty.h, with the noise of steps alone): the path drifts. And a frame whose
// depth image is repeated goes on as the camera went. The factors were measured
// (tests/accuracy/README.md, "Expected error").
// A loop that is closed after the last frame is not known here: the drift is then as before it.
//
// Runs on the host. One thread at a time.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/math/rigid3.h"

namespace hermite::track {

struct ExpectedError {
  // Expected RMS error of the camera's positions after the rigid alignment that fits best, as an
  // absolute trajectory error is computed. Errors of position of different components of a map
  // relative to each other are not included.
  double path_m = 0;
  // What it consists of: standard deviations of single frames, of the views' drift, of frames with
  // repeated depth, and of frames whose place is doubtful; and how far the known errors of the
  // camera's calibration bend the path.
  double step_m = 0, drift_m = 0, stall_m = 0, doubt_m = 0, camera_m = 0;
};

class PathNoise {
 public:
  // Begins a component with a frame that defines its world, and whose pose is therefore exact.
  void begin(double timestamp_s);
  // Counts a further frame, given the covariance of its step as a twist about the world's origin.
  // Returns that covariance, but no larger than that of a camera that goes on
  // as it went (core/math/coasted_motion.h) since the last frame that was well constrained.
  Matrix6d count_step(const Matrix6d& covariance, const Eigen::Vector3d& position_world,
                      double timestamp_s);
  // Counts a frame with a repeated depth image, whose position has this standard deviation along
  // each axis.
  void count_stall(double position_sigma_m);

  // Counts the variance of the position of a frame whose place is doubtful (place_doubt.h), besides
  // its step; and that the doubt about all of them has been settled in their favour.
  void count_doubt(double position_variance_m2) { doubt_variance_sum_m2_ += position_variance_m2; }
  void settle_doubt() { doubt_variance_sum_m2_ = 0; }

  // Counts a frame to the last view.
  void count_between() { ++frames_.back(); }
  // Adds a view whose error is `share` times the errors of the views so far, plus noise.
  void keep(const Eigen::MatrixXd& share, const Matrix6d& noise);
  // Adds the knowledge that this linear function of the views' errors is zero, except for noise.
  void close_loop(const Eigen::MatrixXd& difference, const Matrix6d& noise);
  // Keeps only these views, in increasing order; the first view is one of them.
  void keep_only(const std::vector<std::size_t>& views);
  // Forgets the views, at these positions in the world, but not what they say of the path so far.
  void begin_component(const std::vector<Eigen::Vector3d>& positions_world);

  // `positions_world`: of all views. `known_errors`: six elements for each view, the twist about
  // the world's origin that the camera's calibration is known to cause; may be empty.
  ExpectedError expected(const std::vector<Eigen::Vector3d>& positions_world,
                         const Eigen::VectorXd& known_errors = {}) const;

  std::size_t view_count() const { return frames_.size(); }
  void save(ByteWriter& bytes) const;
  // The reader fails unless there are so many views.
  void restore(ByteReader& bytes, std::size_t view_count);

 private:
  double mean_square_m2(const std::vector<Eigen::Vector3d>& positions_world,
                        const Eigen::MatrixXd& second_moment) const;

  Eigen::MatrixXd covariance_ = Eigen::MatrixXd(0, 0);  // six elements for each view
  // By view: frames from it to before the next.
  std::vector<double> frames_;
  // Timestamp of the last frame that was well constrained.
  double constrained_s_ = 0;
  double frame_count_ = 0, step_count_ = 0;
  double step_variance_sum_m2_ = 0, stall_variance_sum_m2_ = 0;  // over frames
  double doubt_variance_sum_m2_ = 0;                             // over frames since a gap
  // Over frames of components before this one.
  double drift_variance_sum_m2_ = 0, drift_frame_count_ = 0;
};

}  // namespace hermite::track
