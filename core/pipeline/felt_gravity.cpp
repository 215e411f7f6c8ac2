#include "core/pipeline/felt_gravity.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace hermite::pipeline {

namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

constexpr double kGravity_m_s2 = 9.80665;
// The range of common sensors is 2 to 16 g.
constexpr double kMostFelt_m_s2 = 16 * kGravity_m_s2;
// Half of a swing of a hand, which is then felt the other way round.
constexpr double kMotion_s = 0.5;
// Zero-g offset of sensors that nobody calibrated: 25 mg (typical) of the Kinect's KXSD9, up to
// 70 mg of the D435i's BMI055.
constexpr double kBias_m_s2 = 0.4;
// What a hand does, and how many motions this is worth before it was seen.
constexpr double kUsualMotion_m_s2 = 1;
constexpr double kUsualWorth = 4;
// Steps of the Kinect's sensor.
constexpr double kLeastNoise_m_s2 = 0.024;
// Beyond these the values do not belong to this camera: they are in other units, or about other
// axes. Bias and scale of a sensor change its mean by up to 1; a camera that is shaken feels 3.
constexpr double kMostMeanError_m_s2 = 2, kMostResidual_m_s2 = 3.5;

}  // namespace

void FeltGravity::Sums::add(const Sums& other, const Eigen::Matrix3d& from_other) {
  frames += other.frames;
  motions += other.motions;
  rotations += from_other * other.rotations;
  felt_in_submap += from_other * other.felt_in_submap;
  felt_in_camera += other.felt_in_camera;
  squares += other.squares;
}

void FeltGravity::add(const std::optional<Eigen::Vector3d>& acceleration_m_s2,
                      const AnchoredPose& pose) {
  if (!acceleration_m_s2 || pose.status == track::TrackingStatus::kLost) return;
  const Eigen::Vector3d& felt = *acceleration_m_s2;
  if (!felt.allFinite() || felt.norm() > kMostFelt_m_s2) {
    ++unusable_;
    return;
  }
  if (sums_.size() <= pose.submap) sums_.resize(pose.submap + 1);
  Sums& sums = sums_[pose.submap];
  const double since_s = pose.timestamp_s - motion_began_s_;
  if (sums.frames == 0 || since_s >= kMotion_s || since_s < 0) {
    motion_began_s_ = pose.timestamp_s;
    ++sums.motions;
  }
  const Eigen::Matrix3d rotation = pose.submap_from_camera.rotation.toRotationMatrix();
  ++sums.frames;
  sums.rotations += rotation;
  sums.felt_in_submap += rotation * felt;
  sums.felt_in_camera += felt;
  sums.squares += felt.squaredNorm();
}

// The residuals say how much was felt besides gravity, and that how well up is known.
FeltGravity::Solution FeltGravity::solve(const Sums& sums) {
  const auto frames = static_cast<double>(sums.frames), motions = static_cast<double>(sums.motions);
  Matrix6d felt = Matrix6d::Identity() * frames;
  felt.topRightCorner<3, 3>() = sums.rotations;
  felt.bottomLeftCorner<3, 3>() = sums.rotations.transpose();
  Vector6d right;
  right << sums.felt_in_submap, sums.felt_in_camera;
  double variance = kUsualMotion_m_s2 * kUsualMotion_m_s2;
  Solution solution;
  for (int pass = 0; pass < 2; ++pass) {
    const double weight = motions / (frames * variance);
    Matrix6d information = weight * felt;
    information.diagonal().tail<3>().array() += 1 / (kBias_m_s2 * kBias_m_s2);
    const Eigen::LDLT<Matrix6d> solver(information);
    const Vector6d found = solver.solve(weight * right);
    const double squares = sums.squares - 2 * found.dot(right) + found.dot(felt * found);
    const double seen = std::max(0.0, squares / (3 * frames));
    solution.up = found.head<3>();
    solution.residual_m_s2 = std::sqrt(seen);
    const Eigen::Matrix3d covariance = solver.solve(Matrix6d::Identity()).topLeftCorner<3, 3>();
    const Eigen::Vector3d along = solution.up.normalized();
    const Eigen::Matrix3d level = Eigen::Matrix3d::Identity() - along * along.transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> tilt(level * covariance * level,
                                                              Eigen::EigenvaluesOnly);
    solution.sigma_rad = std::sqrt(std::max(0.0, tilt.eigenvalues()[2])) / kGravity_m_s2;
    variance = std::max(kLeastNoise_m_s2 * kLeastNoise_m_s2,
                        (motions * seen + kUsualWorth * kUsualMotion_m_s2 * kUsualMotion_m_s2) /
                            (motions + kUsualWorth));
  }
  return solution;
}

FeltUp FeltGravity::in_world(const adjust::MapLayout& layout) const {
  std::vector<Sums> parts;
  for (std::size_t submap = 0; submap < sums_.size(); ++submap) {
    const std::size_t part = layout.component[submap];
    if (parts.size() <= part) parts.resize(part + 1);
    parts[part].add(sums_[submap], layout.world_from_submap[submap].rotation.toRotationMatrix());
  }
  const auto largest = std::ranges::max_element(parts, {}, &Sums::frames);
  if (largest == parts.end() || largest->frames == 0)
    return {{},
            unusable_ == 0 ? ""
                           : fmt::format("the accelerometer's values are no numbers up to {:.0f} "
                                         "m/s^2",
                                         kMostFelt_m_s2)};
  const Solution solution = solve(*largest);
  const double mean_m_s2 = solution.up.norm();
  if (std::abs(mean_m_s2 - kGravity_m_s2) > kMostMeanError_m_s2)
    return {{},
            fmt::format("the accelerometer feels {:.1f} m/s^2 upwards instead of 9.8: are its "
                        "units and axes those of the camera?",
                        mean_m_s2)};
  if (solution.residual_m_s2 > kMostResidual_m_s2)
    return {{},
            fmt::format("the accelerometer does not turn with the camera: {:.1f} m/s^2 of what it "
                        "feels is neither gravity nor the motion of a hand",
                        solution.residual_m_s2)};
  return {UpDirection{solution.up / mean_m_s2, solution.sigma_rad}, ""};
}

}  // namespace hermite::pipeline
