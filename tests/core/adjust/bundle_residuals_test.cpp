#include "core/adjust/bundle_residuals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/adjust/bundle_noise.h"

namespace hermite::adjust::bundle_residuals_test {
namespace {

const Camera kCamera{640, 480, 525, 520, 319.5, 239.5, 5000};

// Uniform in [-1, 1], by our own mapping: the standard's distributions differ between libraries.
double uniform(std::mt19937& random) { return static_cast<double>(random()) / 2147483648.0 - 1.0; }

Vector6d random_twist(std::mt19937& random, double metres, double radians) {
  Vector6d twist;
  for (int i = 0; i < 6; ++i) twist[i] = uniform(random) * (i < 3 ? metres : radians);
  return twist;
}

Rigid3 random_pose(std::mt19937& random) { return exp_se3(random_twist(random, 3, 1.7)); }

struct Case {
  BundleObservation observation;
  KeyframeView view;
  Rigid3 world_from_submap;
  Eigen::Vector3d landmark_in_world;
};

// A landmark at that depth in a random keyframe of a random submap, measured a little beside where
// it is.
Case random_case(std::mt19937& random, double depth_m, bool with_depth) {
  Case c;
  const BundleKeyframe keyframe{0, random_pose(random)};
  c.view = view_of(keyframe, kCamera);
  c.world_from_submap = random_pose(random);
  const Eigen::Vector3d in_camera(0.4 * uniform(random), 0.4 * uniform(random), depth_m);
  c.landmark_in_world = c.world_from_submap * (keyframe.submap_from_camera * in_camera);
  c.observation.pixel_px =
      Eigen::Vector2d(320 + 200 * uniform(random), 240 + 200 * uniform(random));
  c.observation.depth_m = with_depth ? std::abs(depth_m) + 0.1 : 0;
  c.observation.scale = 1.44;
  return c;
}

Eigen::Vector3d whitened(const Case& c, const Vector6d& twist, const Eigen::Vector3d& move) {
  return observation_residual(c.observation, c.view, c.world_from_submap * exp_se3(twist),
                              c.landmark_in_world + move, nullptr)
      .whitened;
}

// Central differences. Values are up to 1e4 and the third derivatives of the same size, so a step
// of 1e-5 leaves 1e4 * 1e-10 of truncation and 1e4 * 1e-16 / 1e-5 of rounding: 1e-6, measured
// against the largest entry.
constexpr double kStep = 1e-5, kRelativeTolerance = 1e-6;

void expect_derivatives_hold(const Case& c) {
  ObservationDerivatives derivatives;
  observation_residual(c.observation, c.view, c.world_from_submap, c.landmark_in_world,
                       &derivatives);
  Matrix36d by_submap;
  for (int i = 0; i < 6; ++i) {
    const Vector6d step = kStep * Vector6d::Unit(i);
    by_submap.col(i) =
        (whitened(c, step, Eigen::Vector3d::Zero()) - whitened(c, -step, Eigen::Vector3d::Zero())) /
        (2 * kStep);
  }
  Eigen::Matrix3d by_landmark;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
    by_landmark.col(i) =
        (whitened(c, Vector6d::Zero(), step) - whitened(c, Vector6d::Zero(), -step)) / (2 * kStep);
  }
  EXPECT_LT((derivatives.by_submap - by_submap).cwiseAbs().maxCoeff(),
            kRelativeTolerance * by_submap.cwiseAbs().maxCoeff());
  EXPECT_LT((derivatives.by_landmark - by_landmark).cwiseAbs().maxCoeff(),
            kRelativeTolerance * by_landmark.cwiseAbs().maxCoeff());
}

TEST(ObservationResidual, HasTheDerivativesOfItsValues) {
  std::mt19937 random(1);
  for (const double depth_m : {0.31, 0.6, 1.5, 4.0})
    for (int i = 0; i < 25; ++i) expect_derivatives_hold(random_case(random, depth_m, i % 2 == 0));
}

TEST(ObservationResidual, HasThemTooBehindTheCamera) {
  std::mt19937 random(2);
  for (const double depth_m : {0.05, -0.5, -2.0})
    for (int i = 0; i < 25; ++i) expect_derivatives_hold(random_case(random, depth_m, i % 2 == 0));
}

TEST(ObservationResidual, CountsStandardDeviations) {
  // One pixel of scale 2 right of, two above where the landmark is, and one deviation too far.
  const BundleKeyframe keyframe;
  const Eigen::Vector3d landmark(0.2, -0.1, 2.0);
  BundleObservation observation;
  observation.depth_m = 2.1;
  observation.scale = 2;
  observation.pixel_px = kCamera.project(landmark) + Eigen::Vector2d(2, -4);
  const ObservationResidual residual =
      observation_residual(observation, view_of(keyframe, kCamera), Rigid3(), landmark, nullptr);
  EXPECT_NEAR(residual.whitened.x(), -1, 1e-12);
  EXPECT_NEAR(residual.whitened.y(), 2, 1e-12);
  EXPECT_NEAR(residual.whitened.z(), -0.1 / depth_deviation_m(2.1), 1e-9);
  EXPECT_EQ(residual.landmark_depth_m, 2);
  EXPECT_EQ(chi2_bound(observation), kPixelAndDepthChi2);

  observation.depth_m = 0;
  EXPECT_EQ(
      observation_residual(observation, view_of(keyframe, kCamera), Rigid3(), landmark, nullptr)
          .whitened.z(),
      0);
  EXPECT_EQ(chi2_bound(observation), kPixelChi2);
}

TEST(ObservationResidual, IsContinuousAtTheNearestDepth) {
  BundleObservation observation;
  observation.depth_m = 0.5;
  const KeyframeView view = view_of({}, kCamera);
  const auto at = [&](double z) {
    return observation_residual(observation, view, Rigid3(), {0.1, 0.1, z}, nullptr).whitened;
  };
  EXPECT_LT((at(kNearest_m - 1e-9) - at(kNearest_m + 1e-9)).norm(), 1e-3);
  EXPECT_GT(at(-1).squaredNorm(), at(0.05).squaredNorm());  // no gain in going behind
}

Vector6d deviation(const Rigid3& measured, const Rigid3& from, const Rigid3& to,
                   const Vector6d& twist_from, const Vector6d& twist_to) {
  return link_residual(measured, from * exp_se3(twist_from), to * exp_se3(twist_to), nullptr);
}

TEST(LinkResidual, HasTheDerivativesOfItsValues) {
  std::mt19937 random(3);
  // Deviations down to none and up to 179 degrees; around 0.1 rad the coefficients change from
  // series to closed form.
  for (const double radians : {0.0, 1e-9, 1e-3, 0.09, 0.11, 1.0, 2.5, 179.0 * M_PI / 180.0})
    for (int i = 0; i < 10; ++i) {
      const Rigid3 from = random_pose(random), measured = random_pose(random);
      Vector6d off = random_twist(random, 1, 1);
      off.tail<3>() *= radians / off.tail<3>().norm();
      const Rigid3 to = from * measured * exp_se3(off);
      LinkDerivatives derivatives;
      EXPECT_LT((link_residual(measured, from, to, &derivatives) - off).norm(), 1e-9) << radians;
      Matrix6d by_from, by_to;
      for (int k = 0; k < 6; ++k) {
        const Vector6d step = kStep * Vector6d::Unit(k), none = Vector6d::Zero();
        by_from.col(k) = (deviation(measured, from, to, step, none) -
                          deviation(measured, from, to, -step, none)) /
                         (2 * kStep);
        by_to.col(k) = (deviation(measured, from, to, none, step) -
                        deviation(measured, from, to, none, -step)) /
                       (2 * kStep);
      }
      // Entries are near 1 to 10. log_se3 itself is good to 1e-11 at angles near the step (1 - cos
      // loses digits), over the step that is 1e-6.
      EXPECT_LT((derivatives.by_from - by_from).cwiseAbs().maxCoeff(), 1e-6) << radians;
      EXPECT_LT((derivatives.by_to - by_to).cwiseAbs().maxCoeff(), 1e-6) << radians;
    }
}

TEST(SquareRoot, GivesTheInformationBack) {
  std::mt19937 random(4);
  for (int rank = 0; rank <= 6; ++rank) {
    Matrix6d information = Matrix6d::Zero();
    for (int i = 0; i < rank; ++i) {
      const Vector6d v = random_twist(random, 100, 1);
      information += v * v.transpose();
    }
    const Matrix6d root = square_root_of(information);
    EXPECT_LT((root.transpose() * root - information).norm(), 1e-12 * (1 + information.norm()))
        << rank;
  }
}

}  // namespace
}  // namespace hermite::adjust::bundle_residuals_test
