// Joining what depth and colour say about the motion. Pure functions of values, any thread.
#pragma once

#include "core/frame/brightness.h"
#include "core/math/rigid3.h"

namespace hermite {

// hessian * step = right_hand_side for a twist (translation [m], rotation [rad]).
struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d right_hand_side = Vector6d::Zero();
};

// The geometric system without the knowledge it only pretends to have. `displacement` is the weighted sum over the same points of A^T A
// with A = [1, -[s]x], `disagreement` the mean squared sine between the normals of frame and model. The share mu = (x^T H x) /
// (x^T displacement x) of a motion x is the mean squared cosine between the points' movement and their normals: on a bare wall 0 along the
// wall. Noise of the normals by sigma rad makes it sigma^2, and that pretended knowledge holds the camera still, because the noise of depth
// moves with the camera. So in every principal motion the model's sigma^2 is taken off. Frame and model disagree by 2 (sigma_frame^2 +
// sigma_model^2), and the model is no noisier than the frame: sigma^2 is at most a quarter of that.
NormalEquations discount_normal_noise(const NormalEquations& geometric, const Matrix6d& displacement, double disagreement);

// The photometric system with the brightness among its unknowns: hessian and right_hand_side of `motion` are those of the motion alone.
struct PhotometricSystem {
  NormalEquations motion;
  Eigen::Matrix<double, 6, 2> mixed = Eigen::Matrix<double, 6, 2>::Zero();  // motion x (gain, offset)
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();                        // of (gain, offset)
  Eigen::Vector2d right_hand_side = Eigen::Vector2d::Zero();
};

// What the picture says of the motion whatever the brightness: the Schur complement, with a weak prior of gain 1 and offset 0. `at` is
// where the system was linearised. All zero where there is no picture.
NormalEquations without_brightness(const PhotometricSystem& system, const Brightness& at);

// The brightness after the motion has made `step`.
Brightness brightness_after(const PhotometricSystem& system, const Brightness& at, const Vector6d& step);

// The Gauss-Newton step of both together; motions about which neither knows anything stay out of it. Not finite only when the input is not.
Vector6d solve(const NormalEquations& geometric, const NormalEquations& photometric, const Matrix6d& displacement);

// The system of a camera's motion between two frames before anything is seen of it, whose residuals count `unit`: it stays within 0.3 m and
// 0.5 rad of what is expected. `beyond_expected`: the twist from the expected motion to where the system is linearised.
NormalEquations motion_prior(double unit, const Vector6d& beyond_expected);

// What is known about the least-known motion, as a share of what full knowledge of how far it moves the points would be: 0 where it is
// free, as along a bare wall; 1/3 on average where surfaces face all ways.
double observability(const Matrix6d& hessian, const Matrix6d& displacement);

}  // namespace hermite
