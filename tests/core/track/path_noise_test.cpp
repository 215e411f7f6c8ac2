#include "core/track/path_noise.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "core/track/twist_covariance.h"

namespace hermite::track::path_noise_test {

namespace {

constexpr double kStep_m = 0.001, kStep_rad = 0.002;
constexpr double kFramePeriod_s = 1.0 / 30;

// Up and down a room, 0.2 m from view to view.
std::vector<Eigen::Vector3d> walked(std::size_t views) {
  std::vector<Eigen::Vector3d> positions;
  for (std::size_t k = 0; k < views; ++k) {
    const double turn = 0.3 * static_cast<double>(k);
    positions.emplace_back(2 * std::cos(turn), 0.1 * std::sin(3 * turn),
                           1.5 * std::sin(turn) + 0.02 * static_cast<double>(k));
  }
  return positions;
}

// A matrix that takes the error of one view out of so many.
Eigen::MatrixXd of_view(std::size_t view, std::size_t views) {
  Eigen::MatrixXd share = Eigen::MatrixXd::Zero(6, 6 * static_cast<Eigen::Index>(views));
  share.middleCols<6>(6 * static_cast<Eigen::Index>(view)).setIdentity();
  return share;
}

// Each view is tracked against the one before.
PathNoise chain(const std::vector<Eigen::Vector3d>& positions) {
  PathNoise noise;
  for (std::size_t k = 0; k < positions.size(); ++k)
    noise.keep(k == 0 ? Eigen::MatrixXd(6, 0) : of_view(k - 1, k),
               k == 0 ? Matrix6d(Matrix6d::Zero()) : isotropic(kStep_m, kStep_rad, positions[k]));
  return noise;
}

Vector6d random_twist(std::mt19937& random, const Eigen::Vector3d& position) {
  std::normal_distribution<double> normal;
  Vector6d at_position;
  for (Eigen::Index i = 0; i < 6; ++i)
    at_position[i] = (i < 3 ? kStep_m : kStep_rad) * normal(random);
  return at_camera(-position) * at_position;
}

// The root of the mean square of what is left after the best rigid alignment.
double aligned_m(const std::vector<Eigen::Vector3d>& from, const std::vector<Eigen::Vector3d>& to) {
  Eigen::Matrix3Xd source(3, from.size()), target(3, to.size());
  for (std::size_t k = 0; k < from.size(); ++k) {
    source.col(static_cast<Eigen::Index>(k)) = from[k];
    target.col(static_cast<Eigen::Index>(k)) = to[k];
  }
  const Eigen::Matrix4d best = Eigen::umeyama(source, target, false);
  const Eigen::Matrix3Xd left = ((best.topLeftCorner<3, 3>() * source).colwise() +
                                 Eigen::Vector3d(best.topRightCorner<3, 1>())) -
                                target;
  return std::sqrt(left.squaredNorm() / static_cast<double>(from.size()));
}

TEST(PathNoise, ExpectsTheDriftThatRandomStepsHave) {
  const std::vector<Eigen::Vector3d> positions = walked(30);
  std::mt19937 random(1);
  double squares = 0;
  constexpr int kTries = 400;
  for (int i = 0; i < kTries; ++i) {
    Vector6d error = Vector6d::Zero();
    std::vector<Eigen::Vector3d> estimated{positions.front()};
    for (std::size_t k = 1; k < positions.size(); ++k) {
      error += random_twist(random, positions[k]);
      estimated.emplace_back(positions[k] + at_camera(positions[k]).topRows<3>() * error);
    }
    squares += std::pow(aligned_m(estimated, positions), 2);
  }
  const double expected_m = chain(positions).expected(positions).drift_m,
               found_m = std::sqrt(squares / kTries);
  EXPECT_GT(found_m, 2 * kStep_m);
  EXPECT_NEAR(expected_m, found_m, 0.08 * found_m);
}

TEST(PathNoise, MovingAllTogetherIsNoError) {
  const std::vector<Eigen::Vector3d> positions = walked(10);
  PathNoise noise;
  noise.keep(Eigen::MatrixXd(6, 0), isotropic(0.1, 0.1, positions[0]));
  for (std::size_t k = 1; k < positions.size(); ++k) noise.keep(of_view(0, k), Matrix6d::Zero());
  EXPECT_LT(noise.expected(positions).drift_m, 1e-4);
}

TEST(PathNoise, ALoopTakesMostOfTheDrift) {
  const std::vector<Eigen::Vector3d> positions = walked(30);
  PathNoise noise = chain(positions);
  const double open_m = noise.expected(positions).drift_m;
  noise.close_loop(of_view(29, 30) - of_view(0, 30), isotropic(1e-4, 1e-4, positions[29]));
  const double closed_m = noise.expected(positions).drift_m;
  EXPECT_LT(closed_m, 0.7 * open_m);
  EXPECT_GT(closed_m, 0.1 * open_m);
}

TEST(PathNoise, DroppingViewsKeepsTheDrift) {
  const std::vector<Eigen::Vector3d> positions = walked(30);
  PathNoise noise = chain(positions);
  const double before_m = noise.expected(positions).drift_m;
  std::vector<std::size_t> kept;
  std::vector<Eigen::Vector3d> left;
  for (std::size_t k = 0; k < 30; k += 2) {
    kept.push_back(k);
    left.push_back(positions[k]);
  }
  noise.keep_only(kept);
  ASSERT_EQ(noise.view_count(), 15u);
  EXPECT_NEAR(noise.expected(left).drift_m, before_m, 0.1 * before_m);
}

TEST(PathNoise, ANewComponentForgetsViewsButNotTheirDrift) {
  const std::vector<Eigen::Vector3d> positions = walked(30);
  PathNoise noise = chain(positions);
  const double before_m = noise.expected(positions).drift_m;
  noise.begin_component(positions);
  EXPECT_EQ(noise.view_count(), 0u);
  EXPECT_NEAR(noise.expected({}).drift_m, before_m, 1e-9);
}

TEST(PathNoise, AStepWithoutConstraintIsAsUncertainAsAHandThatGoesOn) {
  const Matrix6d held = isotropic(kStep_m, kStep_rad, {0, 0, 0}),
                 free = isotropic(0.3, 0.5, {0, 0, 0});
  PathNoise noise;
  double time_s = 100;
  noise.begin(time_s);
  const auto step = [&](const Matrix6d& covariance) {
    return std::sqrt(noise.count_step(covariance, {0, 0, 0}, time_s += kFramePeriod_s)
                         .topLeftCorner<3, 3>()
                         .trace());
  };
  EXPECT_LT(step(free), 0.01) << "the frame before defines the world";
  EXPECT_NEAR(step(held), std::sqrt(3) * kStep_m, 1e-9);
  const double once_m = step(free);
  EXPECT_GT(once_m, 2 * kStep_m);
  EXPECT_LT(once_m, 0.01) << "a frame's time is too short to go far";
  double last_m = 0;
  for (int i = 0; i < 30; ++i) last_m = step(free);
  EXPECT_GT(last_m, 0.2) << "after a second";
  EXPECT_NEAR(step(held), std::sqrt(3) * kStep_m, 1e-9);
  EXPECT_LT(step(free), 0.01) << "the second is over";
  time_s -= 1;
  EXPECT_GT(step(free), 0.3) << "a clock that goes back limits nothing";
}

TEST(PathNoise, CountsSteps) {
  PathNoise noise;
  EXPECT_EQ(noise.expected({}).path_m, 0) << "nothing is known to be wrong before the first frame";
  for (int i = 0; i < 10; ++i)
    noise.count_step(isotropic(kStep_m, kStep_rad, {1, 2, 3}), {1, 2, 3}, i * kFramePeriod_s);
  const ExpectedError error = noise.expected({});
  EXPECT_NEAR(error.step_m, std::sqrt(3) * kStep_m, 1e-9);
  EXPECT_GT(error.path_m, error.step_m);
  for (int i = 0; i < 10; ++i) noise.count_stall(0.02);
  EXPECT_NEAR(noise.expected({}).stall_m, std::sqrt(3. / 2) * 0.02, 1e-9);
  EXPECT_NEAR(noise.expected({}).step_m, error.step_m, 1e-12);
}

TEST(PathNoise, DoubtAboutThePlaceCountsUntilItIsSettled) {
  PathNoise noise;
  for (int i = 0; i < 10; ++i)
    noise.count_step(isotropic(kStep_m, kStep_rad, {1, 2, 3}), {1, 2, 3}, i * kFramePeriod_s);
  const double without_m = noise.expected({}).path_m;
  for (int i = 0; i < 5; ++i) noise.count_doubt(2 * 2);
  EXPECT_NEAR(noise.expected({}).doubt_m, std::sqrt(5. / 10) * 2, 1e-9);
  EXPECT_GT(noise.expected({}).path_m, 1.4);
  noise.settle_doubt();
  EXPECT_EQ(noise.expected({}).path_m, without_m);
}

TEST(PathNoise, KnownErrorsCountOnlyAsFarAsTheyBendThePath) {
  const std::vector<Eigen::Vector3d> positions = walked(6);
  const PathNoise noise = chain(positions);
  const double without_m = noise.expected(positions).path_m;
  Eigen::VectorXd moved = Eigen::VectorXd::Zero(36), bent = Eigen::VectorXd::Zero(36);
  for (Eigen::Index k = 0; k < 6; ++k) {
    moved.segment<6>(6 * k) << 0.5, 0, 0.2, 0.1, 0, 0;  // all alike: a rigid motion
    bent.segment<3>(6 * k) << 0, 0, k % 2 == 0 ? 0.05 : -0.05;
  }
  EXPECT_NEAR(noise.expected(positions, moved).camera_m, 0, 1e-4);
  EXPECT_NEAR(noise.expected(positions, moved).path_m, without_m, 1e-4);
  EXPECT_NEAR(noise.expected(positions, bent).camera_m, 0.05, 0.01);
  EXPECT_NEAR(noise.expected(positions, bent).path_m,
              std::hypot(without_m, noise.expected(positions, bent).camera_m), 1e-9);
}

TEST(PathNoise, IsSavedAndRestored) {
  const std::vector<Eigen::Vector3d> positions = walked(6);
  PathNoise before = chain(positions);
  before.count_step(isotropic(kStep_m, kStep_rad, positions[5]), positions[5], 1);
  before.count_stall(0.01);
  before.count_doubt(1);
  ByteWriter bytes;
  before.save(bytes);
  const std::string saved = bytes.take();
  PathNoise after;
  ByteReader reader(saved);
  after.restore(reader, 6);
  ASSERT_TRUE(reader.ok());
  EXPECT_EQ(after.expected(positions).path_m, before.expected(positions).path_m);
  EXPECT_EQ(after.expected(positions).drift_m, before.expected(positions).drift_m);
  for (std::size_t size = 0; size < saved.size(); size += 101) {
    PathNoise cut;
    ByteReader short_reader(std::string_view(saved).substr(0, size));
    cut.restore(short_reader, 6);
    EXPECT_FALSE(short_reader.ok()) << size;
  }
  ByteReader other(saved);
  after.restore(other, 5);
  EXPECT_FALSE(other.ok()) << "of another number of views";
}

}  // namespace

}  // namespace hermite::track::path_noise_test
