// The uncertainty of the camera's pose in the world, and whether the camera's calibration fits its
// measurements.
//
// A map has the errors of the poses from which it was made. Views are kept along the path, each
// with the error of the surface first seen in it; a frame that is tracked against that surface
// shares its error. All errors form one Gaussian vector (as in filters with cloned poses:
// Roumeliotis, Burdick 2002, Stochastic cloning): twists xi_k of the views about the world's
// origin, estimated = exp(xi_k) true, and c, the error of the camera's calibration (bend of depth,
// focal length and distortion). For a frame
//   xi = sum_k W_k xi_k + G c + e:
// W_k is the share of the information about its motion that comes from surface first seen in view
// k, so that each direction has the error of the surface that constrains it; G c is the effect of
// the sensor bending points differently in different parts of the image; e is the noise of the
// step. Old surface bounds the uncertainty, new surface inherits it, and a loop is an observation
// of the difference of two errors.
//
// The bend is also observed: two views of the same surface disagree, whatever their poses, as this
// bend predicts. Its mean is part of the state, and with it the resulting errors of poses. The
// others are not observed here; results for all that are found elsewhere are passed in.
//
// Runs on the host. One thread at a time.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"
#include "core/track/calibration_doubt.h"
#include "core/track/kept_views.h"
#include "core/track/path_noise.h"
#include "core/track/place_doubt.h"
#include "core/track/pose_uncertainty.h"
#include "core/track/shared_ground.h"

namespace hermite::track {

class MapCertainty {
 public:
  MapCertainty();

  using Ground = MapGround;

  struct StepError {
    // Covariance of the frame's step (step_certainty.h), as a twist about the world's origin.
    Matrix6d covariance = Matrix6d::Zero();
    double timestamp_s = 0;
    SightGap gap = {};           // before the frame
    bool is_distinctive = true;  // see PlaceDoubt::observe(); only needed while is_in_doubt()
    // By how much surfaces disagree beyond independent noise, see MovingRegions::disagreement().
    double disagreement = 1;
  };

  // Returns the uncertainty of a frame that was tracked against active submaps. `moving` pixels are
  // ignored. The first frame defines the world.
  PoseUncertainty observe(const frame::CoarseView& view, const frame::CoarseMask& moving,
                          const Rigid3& world_from_camera, const StepError& step,
                          const Ground& ground);

  // Returns whether the place of a frame after such a gap is in doubt.
  bool is_in_doubt(const SightGap& gap) const {
    return place_doubt_.elsewhere_m() > 0 || PlaceDoubt::is_cast_by(gap);
  }

  // Counts a frame with a repeated depth image.
  void count_stall(double position_sigma_m) { path_noise_.count_stall(position_sigma_m); }

  // Returns the error to expect of all poses so far.
  ExpectedError expected_error(const Ground& ground) const;

  CalibrationDoubt calibration() const;

  // Takes what an earlier calibration says: standard deviations in the order of CameraDoubt; 0:
  // that of a camera that was never checked, which is also the greatest. CHECK: no frame was
  // observed.
  void begin_with(const CameraDoubts& deviations);

  // Takes that back, since a check of the camera could not confirm it: all that was stated follows.
  void forget_calibration();

  // Returns the root mean square of what the camera's errors may be by now, in the same order.
  CameraDoubts camera_error_rms() const {
    return (covariance_.diagonal().head<kCameraDoubtCount>().cwiseMax(0) +
            mean_.head<kCameraDoubtCount>().cwiseAbs2())
        .cwiseSqrt();
  }

  // Take results of the camera watch (core/calibrate/camera_watch.h): measured errors of the camera
  // and their standard deviations, in the order of CameraDoubt; or that it is certainly off, by
  // this bend and these. What contradicts an earlier calibration takes that back.
  void observe_camera(const CameraDoubts& errors, const CameraDoubts& deviations);
  void camera_is_off(double bend, const CertainErrors& errors);

  // Starts a new component of the map: what follows is relative to its first frame, even if it is
  // later joined to others. Knowledge of the camera is kept. `ground`: the layout in which the
  // component before ended.
  void begin_component(const Ground& ground);

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  Eigen::MatrixXd share_of(const KnownSurface& known) const;
  Matrix6d of_camera(const Eigen::MatrixXd& share) const;
  bool close_loop(const KnownSurface& known, const Matrix6d& step_covariance);
  void learn_camera(const frame::CoarseView& seen, const Rigid3& world_from_camera,
                    const Ground& ground);
  void keep(frame::CoarseView seen, const Rigid3& world_from_camera, const Ground& ground,
            const Eigen::MatrixXd& share, const Matrix6d& noise);
  void drop_some();
  void doubt_place(const KnownSurface& known, const StepError& step, const Ground& ground);
  void update(const Eigen::MatrixXd& of_state, const Eigen::VectorXd& observed,
              const Eigen::MatrixXd& noise);

  std::vector<KeptView> views_;
  std::vector<CameraTerms> learned_;  // of each view with the views before it
  // The state has two elements for the camera, then six for each view.
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;
  Rigid3 kept_world_from_camera_;  // of the last kept view
  double way_m_ = 0;               // sum of distances between consecutive kept views
  // By submap, in the frame before; in the last frame before a loop, until this class has observed
  // the loop.
  std::vector<bool> was_active_;
  std::uint64_t closure_count_ = 0;
  PathNoise path_noise_;  // of the same views
  PlaceDoubt place_doubt_;
  std::size_t known_view_count_ = 0;  // views before the gap that casts doubt on the place
  CertainErrors camera_errors_;       // as reported by camera_is_off()
  // Variances that an earlier calibration has taken from those of a camera that was never checked.
  CameraDoubts withheld_ = CameraDoubts::Zero();
};

// Returns the covariance, as a twist about the world's origin, of a relocalisation at
// `world_from_camera`, where there is no step from the frame before.
Matrix6d found_again(const Rigid3& world_from_camera);

}  // namespace hermite::track
