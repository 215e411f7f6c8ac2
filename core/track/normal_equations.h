// Joining what depth and colour say about the motion. Pure functions of values, any thread.
#pragma once

#include "core/math/rigid3.h"

namespace hermite {

// hessian * step = right_hand_side for a twist (translation [m], rotation [rad]).
struct NormalEquations {
  Matrix6d hessian = Matrix6d::Zero();
  Vector6d right_hand_side = Vector6d::Zero();
};

// The geometric system without the knowledge it only pretends to have. `displacement` is the weighted sum over the same points of A^T A
// with A = [1, -[s]x], `disagreement` the weighted mean squared sine between the normals of frame and model. The share mu = (x^T H x) /
// (x^T displacement x) of a motion x is the mean squared cosine between the points' movement and their normals: on a bare wall 0 along the
// wall. Noise of the normals by sigma rad makes it sigma^2, and that pretended knowledge holds the camera still, because the noise of depth
// moves with the camera. So in every principal motion the model's sigma^2 is taken off. Frame and model disagree by 2 (sigma_frame^2 +
// sigma_model^2), and the model is no noisier than the frame: sigma^2 is at most a quarter of that.
NormalEquations discount_normal_noise(const NormalEquations& geometric, const Matrix6d& displacement, double disagreement);

// The Gauss-Newton step of both together; motions about which neither knows anything stay out of it. Not finite only when the input is not.
Vector6d solve(const NormalEquations& geometric, const NormalEquations& photometric, const Matrix6d& displacement);

// What is known about the least-known motion, as a share of what full knowledge of how far it moves the points would be: 0 where it is
// free, as along a bare wall; 1/3 on average where surfaces face all ways.
double observability(const Matrix6d& hessian, const Matrix6d& displacement);

}  // namespace hermite
