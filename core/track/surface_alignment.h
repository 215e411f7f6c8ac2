// Aligns the surfaces of a frame with an earlier view, by the distances of points to the other
// view's planes and by grey values, and keeps apart what each surface says about the motion. For
// the detection of surfaces that move on their own (core/track/own_motion.h).
//
// Twists are those of earlier_from_frame <- exp(x) earlier_from_frame: translation [m], rotation
// [rad], in the camera frame of the earlier view. Runs on the host. Const functions may be called
// on any thread.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"
#include "core/track/view_surfaces.h"

namespace hermite::track {

// Information about an object's motion between two views before anything is measured: it moves by a
// decimetre or a tenth of a radian.
inline constexpr double kMotionPriorInformation = 1 / (0.1 * 0.1);

// Half the quadratic form of a twist that moves a surface's points.
struct SurfaceSystem {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d right_hand_side = Vector6d::Zero();
  int pairs = 0;

  void add(const Vector6d& row, double residual, double weight) {
    const Vector6d weighted = weight * row;
    for (int column = 0; column < 6; ++column) hessian.col(column) += weighted * row[column];
    right_hand_side.noalias() -= residual * weighted;
  }
};

// Returns the sum of the systems of surfaces that rest, with the prior.
SurfaceSystem sum_of_resting(const std::vector<SurfaceSystem>& systems,
                             const std::vector<bool>& moves);

// Scales of the residuals, and the frame's brightness relative to the earlier view's; updated in
// each step from resting surfaces. At first the scales are robust to motion, and above any noise.
struct ResidualScales {
  double geometric = 3;     // standard deviations of the sensor
  double photometric = 10;  // grey values
  double gain = 1, offset = 0;
};

// Returns the scales before pairs are known: both views are taken to have the same mean brightness.
ResidualScales scales_at_first(const frame::CoarseView& frame, const frame::CoarseView& earlier);

class SurfaceAlignment {
 public:
  // Keeps a reference to `earlier`. `surfaces` are those of `frame`.
  SurfaceAlignment(const frame::CoarseView& frame, const ViewSurfaces& surfaces,
                   const frame::CoarseView& earlier);

  struct Result {
    Rigid3 earlier_from_frame;
    ResidualScales scales;
    std::vector<SurfaceSystem> systems;  // by surface, at this pose; empty of those that move
  };

  // Takes `steps` Gauss-Newton steps from a pose, by the surfaces for which `moves` is false.
  Result align(const Rigid3& earlier_from_frame, const ResidualScales& scales,
               const std::vector<bool>& moves, int steps) const;

  // Returns the number of surfaces of the frame, number 0 included.
  std::size_t surface_count() const { return first_of_surface_.size() - 1; }

 private:
  // A pixel of the frame that can be paired, as every linearisation needs it.
  struct Pixel {
    Eigen::Vector3d point, normal;
    Eigen::Vector2d uv, gradient;  // `gradient` in grey values per pixel
    double grey = -1;              // negative: no gradient, or saturated
  };
  struct Placement;
  struct Spread;
  static Pixel pixel_at(const frame::CoarseView& frame, int x, int y);
  double earlier_grey_at(double u, double v) const;
  void add(const Pixel& pixel, const Placement& earlier_from_frame, const ResidualScales& scales,
           SurfaceSystem& system, Spread& spread) const;
  std::vector<SurfaceSystem> linearise(const Rigid3& earlier_from_frame,
                                       const std::vector<bool>& moves,
                                       ResidualScales& scales) const;

  // Of the frame, by surface: those of surface `s` are first_of_surface_[s] to
  // first_of_surface_[s + 1].
  std::vector<Pixel> pixels_;
  std::vector<std::size_t> first_of_surface_;
  const frame::CoarseView& earlier_;
  // Of the earlier view, row major; of pixels that have a depth.
  std::vector<Eigen::Vector3d> earlier_points_, earlier_normals_;
};

}  // namespace hermite::track
