#include "core/math/hrbf.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace hermite {

namespace {

constexpr double kCoefficient = 200;         // 20 C with C = 10
constexpr double kConfidenceEpsilon = 1000;  // paper Eq. 5
constexpr double kCentre = 1e-12;            // |x - p| / r below which x is the kernel's centre

void add_kernel(const HrbfKernel& kernel, const Eigen::Vector3d& point_m, bool own,
                HrbfSample& sample) {
  const Eigen::Vector3d& n = kernel.normal;
  const Eigen::Vector3d v = point_m - kernel.position_m;
  const double r2 = kernel.radius_m * kernel.radius_m;
  const double rho = v.norm() / kernel.radius_m;
  if (!(rho < 1)) return;
  const double s = 1 - rho, u = n.dot(v), weight = kCoefficient / r2;
  ++sample.support_count;
  sample.value += weight * s * s * s * u;
  sample.gradient += weight * s * s * s * n;
  if (rho < kCentre) return;
  const double q = s * s / rho;
  sample.gradient -= weight * 3 / r2 * q * u * v;
  if (own) return;
  const Eigen::Matrix3d nv = n * v.transpose();
  const double c = (1 / (rho * rho) - 1) / (r2 * rho) * u;
  sample.hessian -=
      weight * 3 / r2 *
      (q * (nv + nv.transpose() + u * Eigen::Matrix3d::Identity()) - c * v * v.transpose());
}

// Returns the adjugate of a symmetric matrix.
Eigen::Matrix3d adjoint(const Eigen::Matrix3d& m) {
  Eigen::Matrix3d result;
  result.row(0) = m.col(1).cross(m.col(2));
  result.row(1) = m.col(2).cross(m.col(0));
  result.row(2) = m.col(0).cross(m.col(1));
  return result;
}

// A normal that is mixed into those of all kernels.
struct MixedNormal {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double share = 0;  // 0 to 1; the kernels' own normals have the rest
};

// Intersects the ray with the planes of all kernels that reach t * ray and returns the weighted
// mean. Returns NaN if no kernel reaches the point.
double step_along_ray(std::span<const HrbfKernel> kernels, const Eigen::Vector3d& ray, double t,
                      const MixedNormal& other) {
  double plane = 0, slope = 0;
  for (const HrbfKernel& kernel : kernels) {
    const double s = 1 - (t * ray - kernel.position_m).norm() / kernel.radius_m;
    if (!(s > 0)) continue;
    const double w = s * s * s / (kernel.radius_m * kernel.radius_m);
    const Eigen::Vector3d n = (1 - other.share) * kernel.normal + other.share * other.normal;
    plane += w * n.dot(kernel.position_m);
    slope += w * n.dot(ray);
  }
  return slope == 0 ? std::numeric_limits<double>::quiet_NaN() : plane / slope;
}

struct RaySolution {
  double t = 0;
  int evaluation_count = 0;
};

std::optional<RaySolution> iterate(std::span<const HrbfKernel> kernels, const Eigen::Vector3d& ray,
                                   double t, const MixedNormal& other,
                                   const HrbfRayOptions& options) {
  for (int count = 1; count <= options.max_evaluation_count; ++count) {
    const double next = step_along_ray(kernels, ray, t, other);
    if (!std::isfinite(next)) return std::nullopt;
    const double step_m = std::abs(next - t) * ray.norm();
    t = next;
    if (step_m < options.tolerance_m) return RaySolution{t, count};
  }
  return std::nullopt;
}

}  // namespace

HrbfSample evaluate_hrbf(std::span<const HrbfKernel> kernels, const Eigen::Vector3d& point_m,
                         std::optional<std::size_t> own) {
  HrbfSample sample;
  for (std::size_t i = 0; i < kernels.size(); ++i)
    add_kernel(kernels[i], point_m, i == own, sample);
  return sample;
}

std::optional<PrincipalCurvatures> principal_curvatures(const Eigen::Vector3d& gradient,
                                                        const Eigen::Matrix3d& hessian) {
  const double g = gradient.norm();
  if (!(g > 0) || !std::isfinite(g)) return std::nullopt;
  const double mean =
      (gradient.dot(hessian * gradient) - g * g * hessian.trace()) / (2 * g * g * g);
  const double gaussian = gradient.dot(adjoint(hessian) * gradient) / (g * g * g * g);
  const double root = std::sqrt(std::max(0.0, mean * mean - gaussian));
  return PrincipalCurvatures{mean + root, mean - root};
}

double hrbf_confidence(const Eigen::Vector3d& gradient, const Eigen::Vector3d& normal) {
  return std::exp(-kConfidenceEpsilon / std::sqrt(std::abs(gradient.dot(normal))));
}

std::optional<HrbfIntersection> intersect_hrbf(std::span<const HrbfKernel> kernels,
                                               const Eigen::Vector3d& ray,
                                               const HrbfRayOptions& options) {
  if (kernels.empty()) return std::nullopt;
  double start = std::numeric_limits<double>::infinity();
  for (const HrbfKernel& kernel : kernels)
    start = std::min(start, kernel.position_m.dot(ray) / ray.squaredNorm());

  std::optional<RaySolution> solution = iterate(kernels, ray, start, {}, options);
  if (!solution) return std::nullopt;
  int evaluation_count = solution->evaluation_count;
  if (options.correct_bias) {
    const Eigen::Vector3d first_normal =
        evaluate_hrbf(kernels, solution->t * ray).gradient.normalized();
    solution = iterate(kernels, ray, solution->t, {first_normal, 0.5}, options);
    if (!solution) return std::nullopt;
    evaluation_count += solution->evaluation_count;
  }
  const HrbfSample sample = evaluate_hrbf(kernels, solution->t * ray);
  const bool front = solution->t > 0 && sample.gradient.dot(ray) > 0;
  if (!front || sample.support_count < options.min_support_count) return std::nullopt;
  return HrbfIntersection{solution->t, solution->t * ray, sample.gradient.normalized(),
                          sample.support_count, evaluation_count};
}

}  // namespace hermite
