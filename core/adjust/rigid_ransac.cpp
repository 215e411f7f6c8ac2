#include "core/adjust/rigid_ransac.h"

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "core/adjust/bundle_noise.h"

namespace hermite::adjust {
namespace {

constexpr double kGateSigmas = 3;
// Probability of stopping before a sample of inliers alone was drawn.
constexpr double kMissedChance = 0.001;
constexpr std::size_t kSampleSize = 3;
constexpr int kMaxRefits = 10;  // the inliers are stable after 2 or 3
// From a pose accurate to some pixels, the third step is below a micrometre.
constexpr int kGaussNewtonSteps = 3;

// A pair with precomputed values for the inlier tests.
struct Measurement {
  Eigen::Vector3d in_camera, in_world;
  Eigen::Vector2d pixel_px;
  double pixel_sigma_px, depth_sigma_m, world_sigma_m;
  std::uint32_t pair;

  double sigma_m() const { return std::hypot(depth_sigma_m, world_sigma_m); }
};
using Sample = std::array<const Measurement*, kSampleSize>;

std::vector<Measurement> usable(const std::vector<PointPair>& pairs, const Camera& camera) {
  std::vector<Measurement> measurements;
  measurements.reserve(pairs.size());
  for (std::uint32_t i = 0; i < pairs.size(); ++i) {
    const PointPair& pair = pairs[i];
    const bool finite = pair.point_in_camera_m.allFinite() && pair.point_in_world_m.allFinite();
    if (!finite || !(pair.point_in_camera_m.z() > 0) || !(pair.pixel_sigma_px > 0) ||
        !(pair.world_sigma_m >= 0))
      continue;
    measurements.push_back({pair.point_in_camera_m, pair.point_in_world_m,
                            camera.project(pair.point_in_camera_m), pair.pixel_sigma_px,
                            depth_deviation_m(pair.point_in_camera_m.z()), pair.world_sigma_m, i});
  }
  return measurements;
}

// Returns whether the sample can determine a rigid pose: the distances of its world points agree
// with those in the camera within noise, and they span a triangle wide enough that noise does not
// rotate it about its longest side.
bool fits_rigidly(const Sample& sample) {
  double longest_m = 0, sigma_m = 0;
  for (std::size_t i = 0; i < kSampleSize; ++i) {
    const Measurement &a = *sample[i], &b = *sample[(i + 1) % kSampleSize];
    const double in_camera_m = (a.in_camera - b.in_camera).norm(),
                 in_world_m = (a.in_world - b.in_world).norm();
    if (std::abs(in_camera_m - in_world_m) > kGateSigmas * std::hypot(a.sigma_m(), b.sigma_m()))
      return false;
    longest_m = std::max(longest_m, in_camera_m);
    sigma_m = std::max(sigma_m, a.sigma_m());
  }
  const Eigen::Vector3d &a = sample[0]->in_camera, &b = sample[1]->in_camera,
                        &c = sample[2]->in_camera;
  const double height_m = (b - a).cross(c - a).norm() / std::max(longest_m, 1e-9);
  return height_m > kGateSigmas * sigma_m;
}

// Umeyama 1991 without scale, for three points.
Rigid3 world_from_sample(const Sample& sample) {
  Eigen::Vector3d camera_mean = Eigen::Vector3d::Zero(), world_mean = Eigen::Vector3d::Zero();
  for (const Measurement* measurement : sample) {
    camera_mean += measurement->in_camera / kSampleSize;
    world_mean += measurement->in_world / kSampleSize;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Measurement* measurement : sample)
    covariance +=
        (measurement->in_world - world_mean) * (measurement->in_camera - camera_mean).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d signs(1, 1,
                        svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1);
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return {Eigen::Quaterniond(rotation).normalized(), world_mean - rotation * camera_mean};
}

// Variances of a measurement relative to the map point, seen at `depth_m`.
struct Variances {
  double pixel_px2, depth_m2;
};
Variances variances(const Measurement& measurement, const Camera& camera, double depth_m) {
  const double world_px = camera.fx * measurement.world_sigma_m / depth_m;
  return {measurement.pixel_sigma_px * measurement.pixel_sigma_px + world_px * world_px,
          measurement.depth_sigma_m * measurement.depth_sigma_m +
              measurement.world_sigma_m * measurement.world_sigma_m};
}

std::vector<std::uint32_t> inliers_of(const std::vector<Measurement>& measurements,
                                      const Camera& camera, const Rigid3& world_from_camera) {
  const Rigid3 camera_from_world = inverse(world_from_camera);
  const Eigen::Matrix3d rotation = camera_from_world.rotation.toRotationMatrix();
  std::vector<std::uint32_t> inliers;
  for (std::uint32_t i = 0; i < measurements.size(); ++i) {
    const Measurement& measurement = measurements[i];
    const Eigen::Vector3d predicted =
        rotation * measurement.in_world + camera_from_world.translation;
    if (!(predicted.z() > 0)) continue;
    const Variances allowed = variances(measurement, camera, predicted.z());
    const double depth_error_m = predicted.z() - measurement.in_camera.z();
    if (depth_error_m * depth_error_m > kGateSigmas * kGateSigmas * allowed.depth_m2) continue;
    if ((camera.project(predicted) - measurement.pixel_px).squaredNorm() >
        kGateSigmas * kGateSigmas * allowed.pixel_px2)
      continue;
    inliers.push_back(i);
  }
  return inliers;
}

// Gauss-Newton on the residuals in pixels and depth, each over its standard deviation. The twist
// acts on points in the camera frame.
Rigid3 fit(const std::vector<Measurement>& measurements, const std::vector<std::uint32_t>& inliers,
           const Camera& camera, const Rigid3& guess) {
  Rigid3 camera_from_world = inverse(guess);
  for (int step = 0; step < kGaussNewtonSteps; ++step) {
    Matrix6d normal = Matrix6d::Zero();
    Vector6d right = Vector6d::Zero();
    for (const std::uint32_t i : inliers) {
      const Measurement& measurement = measurements[i];
      const Eigen::Vector3d p = camera_from_world * measurement.in_world;
      if (!(p.z() > 0)) continue;
      const Variances variance = variances(measurement, camera, p.z());
      Eigen::Matrix3d by_point;  // d (u, v, z) / d point
      by_point << camera.fx / p.z(), 0, -camera.fx * p.x() / (p.z() * p.z()), 0, camera.fy / p.z(),
          -camera.fy * p.y() / (p.z() * p.z()), 0, 0, 1;
      Eigen::Matrix<double, 3, 6> by_twist;
      by_twist.leftCols<3>() = by_point;
      for (int axis = 0; axis < 3; ++axis)
        by_twist.col(3 + axis) = by_point * Eigen::Vector3d::Unit(axis).cross(p);
      const Eigen::Vector2d pixel_error_px = camera.project(p) - measurement.pixel_px;
      const Eigen::Vector3d residual(pixel_error_px.x(), pixel_error_px.y(),
                                     p.z() - measurement.in_camera.z());
      const Eigen::Vector3d weight(1 / variance.pixel_px2, 1 / variance.pixel_px2,
                                   1 / variance.depth_m2);
      normal += by_twist.transpose() * weight.asDiagonal() * by_twist;
      right -= by_twist.transpose() * weight.asDiagonal() * residual;
    }
    const Vector6d twist = normal.ldlt().solve(right);
    if (!twist.allFinite()) return guess;
    camera_from_world = exp_se3(twist) * camera_from_world;
  }
  return inverse(camera_from_world);
}

std::optional<RigidMatch> refine(const std::vector<Measurement>& measurements, const Camera& camera,
                                 Rigid3 pose, std::size_t least_inliers) {
  least_inliers = std::max(least_inliers, kSampleSize);
  std::vector<std::uint32_t> inliers = inliers_of(measurements, camera, pose);
  for (int i = 0; i < kMaxRefits && inliers.size() >= kSampleSize; ++i) {
    pose = fit(measurements, inliers, camera, pose);
    std::vector<std::uint32_t> next = inliers_of(measurements, camera, pose);
    const bool settled = next == inliers;
    inliers = std::move(next);
    if (settled) break;
  }
  if (inliers.size() < least_inliers || !is_finite(pose)) return std::nullopt;
  for (std::uint32_t& inlier : inliers) inlier = measurements[inlier].pair;
  return RigidMatch{pose, std::move(inliers)};
}

// Returns the number of draws after which a sample of inliers alone was missed with probability
// kMissedChance.
double needed_draws(std::size_t inlier_count, std::size_t count) {
  const double inlier_share = static_cast<double>(inlier_count) / static_cast<double>(count);
  const double chance = std::min(inlier_share * inlier_share * inlier_share, 1 - 1e-9);
  return std::log(kMissedChance) / std::log1p(-chance);
}

}  // namespace

std::optional<RigidMatch> match_rigidly(const std::vector<PointPair>& pairs, const Camera& camera,
                                        const RansacOptions& options) {
  const std::vector<Measurement> measurements = usable(pairs, camera);
  if (measurements.size() < std::max(options.least_inliers, kSampleSize)) return std::nullopt;
  std::mt19937 random(options.seed);
  // Maps random bits to an index without std::uniform_int_distribution, which differs between
  // standard libraries.
  const auto any = [&] {
    return static_cast<std::size_t>((static_cast<std::uint64_t>(random()) * measurements.size()) >>
                                    32);
  };

  Rigid3 best_pose;
  std::size_t best_count = 0;
  double enough = kMaxDraws;
  for (int draw = 0; draw < kMaxDraws && draw < enough; ++draw) {
    const Sample sample{&measurements[any()], &measurements[any()], &measurements[any()]};
    if (!fits_rigidly(sample)) continue;
    const Rigid3 pose = world_from_sample(sample);
    std::vector<std::uint32_t> inliers = inliers_of(measurements, camera, pose);
    if (inliers.size() <= best_count) continue;
    best_count = inliers.size();
    best_pose = pose;
    // Three noisy points give a noisy pose; one fit to its inliers finds most of the others
    // (locally optimised RANSAC).
    if (inliers.size() > kSampleSize) {
      const Rigid3 fitted = fit(measurements, inliers, camera, pose);
      inliers = inliers_of(measurements, camera, fitted);
      if (inliers.size() > best_count) {
        best_count = inliers.size();
        best_pose = fitted;
      }
    }
    enough = needed_draws(best_count, measurements.size());
  }
  if (best_count < kSampleSize) return std::nullopt;
  return refine(measurements, camera, best_pose, options.least_inliers);
}

std::optional<RigidMatch> refine_rigidly(const std::vector<PointPair>& pairs, const Camera& camera,
                                         const Rigid3& world_from_camera_guess,
                                         std::size_t least_inliers) {
  return refine(usable(pairs, camera), camera, world_from_camera_guess, least_inliers);
}

}  // namespace hermite::adjust
