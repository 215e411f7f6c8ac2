// Combines what depth and colour say about the motion. Pure functions of values. Any thread.
#pragma once

#include "core/frame/brightness.h"
#include "core/math/rigid3.h"

namespace hermite::track {

// hessian * step = right_hand_side for a twist (translation [m], rotation [rad]).
struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d right_hand_side = Vector6d::Zero();
};

// Returns the geometric system without the information that only comes from noise. `displacement`
// is the weighted sum over the same points of A^T A with A = [1, -[s]x], `disagreement` the mean
// squared sine between the normals of frame and model. For a motion x, mu = (x^T H x) / (x^T
// displacement x) is the mean squared cosine between the points' movement and their normals: on a
// bare wall, 0 along the wall. Noise of the normals of sigma rad makes it sigma^2, and that false
// information keeps the camera still, because the noise of depth moves with the camera. So the
// model's sigma^2 is subtracted in every principal motion. Frame and model disagree by 2
// (sigma_frame^2 + sigma_model^2), and the model is no noisier than the frame, so sigma^2 is at
// most a quarter of that.
NormalEquations discount_normal_noise(const NormalEquations& geometric,
                                      const Matrix6d& displacement, double disagreement);

// The photometric system with the brightness as further unknowns: hessian and right_hand_side of
// `motion` are those of the motion alone.
struct PhotometricSystem {
  NormalEquations motion;
  // Motion x (gain, offset).
  Eigen::Matrix<double, 6, 2> mixed = Eigen::Matrix<double, 6, 2>::Zero();
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();  // of (gain, offset)
  Eigen::Vector2d right_hand_side = Eigen::Vector2d::Zero();
};

// Returns what the image says about the motion with the brightness eliminated: the Schur
// complement, with a weak prior of gain 1 and offset 0. `at` is where the system was linearised.
// All zero if there is no image.
NormalEquations without_brightness(const PhotometricSystem& system, const frame::Brightness& at);

// Returns the brightness after the motion has made `step`.
frame::Brightness brightness_after(const PhotometricSystem& system, const frame::Brightness& at,
                                   const Vector6d& step);

// Returns the Gauss-Newton step of both systems together; it is zero along motions about which
// neither has information. Finite for finite input.
Vector6d solve(const NormalEquations& geometric, const NormalEquations& photometric,
               const Matrix6d& displacement);

// Returns the prior of a camera's motion between two frames, in a system whose residuals count
// `unit`: it stays within 0.3 m and 0.5 rad of the expected motion. `beyond_expected` is the twist
// from the expected motion to the linearisation point.
NormalEquations motion_prior(double unit, const Vector6d& beyond_expected);

// Returns the information about the least-known motion as a share of full knowledge of the points'
// displacement: 0 where the motion is free, as along a bare wall; 1/3 on average where surfaces
// face all directions.
double observability(const Matrix6d& hessian, const Matrix6d& displacement);

// Below this observability, what is known about a motion is mostly noise. Small images of bare
// walls with texture have at least 6.6e-5 and end 2.5 mm off; blank ones have a median of 1.5e-5
// and end 88 mm off.
constexpr double kNoiseObservability = 4e-5;

// Returns P such that P^T hessian P has kNoiseObservability less in every principal motion, and
// nothing where there was less. P^T X P then is what any part X of the information says beyond
// noise. Identity if there are no points.
Matrix6d beyond_noise(const Matrix6d& hessian, const Matrix6d& displacement);

}  // namespace hermite::track
