// The closed-form Hermite RBF implicit function of a set of oriented points (paper Eq. 2 and 3) in
// double precision: the reference for the shaders.
//
//   f(x) = sum_j (200 / r_j^2) s^3 n_j.(x - p_j),
//   s = 1 - |x - p_j| / r_j  inside the support, else 0
//
// The coefficient is constant (10 instead of r^2 / (20 + eta r^2) in Eq. 3), for which the paper's
// confidence (Eq. 5) is scaled; the zero set does not depend on it. All points are in one
// coordinate frame, in metres, with unit normals that point AWAY from the camera at the origin: f
// is negative in front of the surface and positive behind it, and surfaces that bulge towards the
// camera have positive curvature. Pure functions of values.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>

namespace hermite {

struct HrbfKernel {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, away from the camera
  double radius_m = 0;                               // of the support, positive
};

struct HrbfSample {
  double value = 0;                                    // f [1/m]
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  // [1/m^2]
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();   // [1/m^3]
  int support_count = 0;                               // kernels whose support contains the point
};

// Evaluates f and its derivatives. The second derivative of a kernel is discontinuous at its own
// centre, where it contributes only to the gradient. Close to the centre its Hessian is finite but
// says nothing about the surface and dominates the others. So for a pixel whose vertex was moved
// onto the zero set, `own` is the index of its own kernel, whose Hessian is left out.
HrbfSample evaluate_hrbf(std::span<const HrbfKernel> kernels, const Eigen::Vector3d& point_m,
                         std::optional<std::size_t> own = std::nullopt);

struct PrincipalCurvatures {
  double max_per_m = 0, min_per_m = 0;  // max_per_m >= min_per_m, with sign
};

// Returns H +- sqrt(H^2 - K) of the level set through the point (paper Eq. 4; its Gaussian
// curvature lacks the minus sign before the determinant); std::nullopt if the gradient vanishes.
std::optional<PrincipalCurvatures> principal_curvatures(const Eigen::Vector3d& gradient,
                                                        const Eigen::Matrix3d& hessian);

// Returns exp(-1000 / sqrt(|gradient . normal|)), 0 to 1: how densely and consistently the surface
// is sampled (paper Eq. 5 with the square root for which its constant is meant).
double hrbf_confidence(const Eigen::Vector3d& gradient, const Eigen::Vector3d& normal);

struct HrbfRayOptions {
  int max_evaluation_count = 20;
  double tolerance_m = 1e-6;  // last step along the ray
  int min_support_count = 7;  // kernels that must support the solution
  // On a curved surface, the zero set is displaced to the convex side by about 0.063 H r^2 for a
  // 7x7 window and 0.072 H r^2 for one that contains the whole support (H is the mean curvature).
  // Planes whose normals are half-way to the normal of a first solution remove this bias.
  bool correct_bias = false;
};

struct HrbfIntersection {
  double ray_parameter = 0;  // point = ray_parameter * ray
  Eigen::Vector3d point_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit gradient, away from the camera
  int support_count = 0;
  int evaluation_count = 0;
};

// Returns where the ray from the origin along `ray` (any length, not zero) meets the zero set, by
// the weighted-plane iteration t <- sum w n.p / sum w n.ray, w = s^3 / r^2, starting at the nearest
// projection of a kernel onto the ray. Returns std::nullopt if the iteration leaves all supports,
// does not converge, converges behind the origin or on a back side, or if fewer than
// min_support_count kernels reach the point.
std::optional<HrbfIntersection> intersect_hrbf(std::span<const HrbfKernel> kernels,
                                               const Eigen::Vector3d& ray,
                                               const HrbfRayOptions& options = {});

}  // namespace hermite
