// How well it is known where the camera is in the world, and whether the camera's calibration fits what it sees.
//
// A map is as wrong as the poses it was made from. Views are kept along the way, each with the error of the ground that was first seen in
// it; a frame that is tracked against that ground shares its error. So all errors are one Gaussian vector (as in filters with cloned poses:
// Roumeliotis, Burdick 2002, Stochastic cloning): twists xi_k of the views, estimated = exp(xi_k) true, about the world's origin, and c,
// what is wrong with the camera (its bend of depth and its focal length). Of a frame
//   xi = sum_k W_k xi_k + G c + e:
// W_k is the share of the information about its motion that comes from ground first seen in view k, so that each direction has the error of
// what holds it; G c is what the points do when the sensor bends them one way in one part of the image and another way in another; e is the
// noise of the step. Old ground bounds the uncertainty, new ground inherits it, a loop is an observation of the difference of two of them.
//
// The bend is observed too: two views of the same ground disagree, whatever their poses, as the same bend would have it. Its mean is
// carried along, and with it what the poses are off by already. The focal length is not; what is found of either elsewhere is told.
//
// Host only, no GPU. One thread at a time.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"
#include "core/track/shared_ground.h"

namespace hermite {

// Of world_from_camera, in a world that is the first frame of the part of the map: error of the position in the world's axes [m], then of
// the rotation, as a vector in the world's axes [rad] (estimated = exp(error) true). The mean of its square: what is known of systematic
// errors is in it.
struct PoseUncertainty {
  Matrix6d second_moment = Matrix6d::Zero();
  double way_m = 0;  // that the camera has gone since that first frame

  // Along the axis of the greatest error.
  double position_sigma_m() const;
  double rotation_sigma_rad() const;
  // Unit, in the world: where the position is known least.
  Eigen::Vector3d worst_direction() const;
};

// Whether depth in the corners of the image is too great, as a share of it.
struct CalibrationDoubt {
  double bend = 0, deviation = 0;
  double focal = 0;  // by how much the focal length is said to be too great, when that is beyond doubt
  // In words, when what is seen contradicts the calibration of depth beyond doubt; else empty.
  std::string reason() const;
};

class MapCertainty {
 public:
  MapCertainty();

  // Where the map lies now.
  struct Ground {
    const std::vector<Rigid3>& world_from_submap;
    const std::vector<bool>& is_active;  // by submap: tracked against
    std::uint32_t current = 0;           // submap of what is new
    std::uint64_t closure_count = 0;     // loops closed so far
  };

  // A frame that was tracked against active ground, with the covariance of its step (step_certainty.h) as a twist about the world's origin.
  // `moving` pixels do not count. The first frame is the world.
  PoseUncertainty observe(const CoarseView& view, const CoarseMask& moving, const Rigid3& world_from_camera,
                          const Matrix6d& step_covariance, const Ground& ground);

  CalibrationDoubt calibration() const;

  // Somebody else has looked (core/calibrate/camera_watch.h): the camera is right up to these standard deviations, as shares, or off by so
  // much.
  void camera_fits(double bend_deviation, double focal_deviation);
  void camera_is_off(double bend, double focal);

  // The map goes on in a part of its own: what follows is relative to its first frame, also when the part is joined to others. What is
  // known of the camera stays.
  void begin_component();

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  struct View {
    CoarseView seen;  // thinned, without what moves
    std::uint32_t submap = 0;
    Rigid3 submap_from_camera;
  };
  struct Hold;
  static bool is_tracked_against(const View& view, const Ground& ground) {
    return view.submap < ground.is_active.size() && ground.is_active[view.submap];
  }
  static Rigid3 world_from_view(const View& view, const Ground& ground) {
    return ground.world_from_submap[view.submap] * view.submap_from_camera;
  }
  Hold hold_of(const CoarseView& seen, const Rigid3& world_from_camera, const Ground& ground) const;
  Eigen::MatrixXd share_of(const Hold& hold) const;
  bool close_loop(const Hold& hold, const Matrix6d& step_covariance);
  void learn_camera(const CoarseView& seen, const Rigid3& world_from_camera, const Ground& ground);
  void keep(CoarseView seen, const Rigid3& world_from_camera, const Ground& ground, const Eigen::MatrixXd& share, const Matrix6d& noise);
  void drop_some();
  void observe_camera(const Eigen::Vector2d& doubts, const Eigen::Vector2d& deviations);
  void update(const Eigen::MatrixXd& of_state, const Eigen::VectorXd& observed, const Eigen::MatrixXd& noise);

  std::vector<View> views_;
  std::vector<CameraTerms> learned_;  // of each view with those before it
  // Of the state: two numbers of the camera, then six of each view.
  Eigen::VectorXd mean_;
  Eigen::MatrixXd covariance_;
  Rigid3 kept_world_from_camera_;  // of the view kept last
  double way_m_ = 0;               // from view to view
  std::vector<bool> was_active_;   // by submap, in the frame before; of the last frame before a loop that is not yet seen here
  std::uint64_t closure_count_ = 0;
  double focal_off_ = 0;  // as told
};

// The covariance of a step that is not one: a lost camera was found again at `world_from_camera`, as a twist about the world's origin.
Matrix6d found_again(const Rigid3& world_from_camera);

}  // namespace hermite
