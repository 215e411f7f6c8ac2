#include "core/track/normal_equations.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <vector>

namespace hermite::track::normal_equations_test {
namespace {

using Eigen::Vector3d;

struct Pair {
  Vector3d point, model_normal, frame_normal;
  double distance_m;
};

struct Sums {
  NormalEquations geometric;
  Matrix6d displacement = Matrix6d::Zero();
  double disagreement = 0;
};

Sums sums_of(const std::vector<Pair>& pairs) {
  Sums sums;
  for (const Pair& pair : pairs) {
    Vector6d row;
    row << pair.model_normal, pair.point.cross(pair.model_normal);
    sums.geometric.hessian += row * row.transpose();
    sums.geometric.right_hand_side -= pair.distance_m * row;
    for (int axis = 0; axis < 3; ++axis) {
      Vector6d moved;
      moved << Vector3d::Unit(axis), pair.point.cross(Vector3d::Unit(axis));
      sums.displacement += moved * moved.transpose();
    }
    sums.disagreement += pair.frame_normal.cross(pair.model_normal).squaredNorm() /
                         static_cast<double>(pairs.size());
  }
  return sums;
}

// A wall 2 m away, measured after the camera has come nearer by 1 cm; `noise_rad` in each axis of
// both normals.
std::vector<Pair> wall(double noise_rad) {
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0, noise_rad);
  const auto tilted = [&](double x, double y) { return Vector3d(x, y, 1).normalized(); };
  std::vector<Pair> pairs;
  for (int y = -20; y <= 20; ++y)
    for (int x = -20; x <= 20; ++x) {
      const Vector3d model = tilted(noise(random), noise(random)),
                     frame = tilted(noise(random), noise(random));
      pairs.push_back({{0.05 * x, 0.05 * y, 2}, model, frame, -0.01});
    }
  return pairs;
}

// mu of a motion, as the header defines it.
double share(const Matrix6d& hessian, const Matrix6d& displacement, const Vector6d& motion) {
  return motion.dot(hessian * motion) / motion.dot(displacement * motion);
}

TEST(NormalEquations, OfABareWallWithNoisyNormalsOnlyWhatItSeesRemains) {
  const Sums sums = sums_of(wall(0.05));
  const NormalEquations kept =
      discount_normal_noise(sums.geometric, sums.displacement, sums.disagreement);
  const Vector6d along_x = Vector6d::Unit(0), towards = Vector6d::Unit(2);
  EXPECT_NEAR(share(sums.geometric.hessian, sums.displacement, along_x), 0.05 * 0.05, 0.0005)
      << "pretended";
  EXPECT_LT(share(kept.hessian, sums.displacement, along_x), 0.0003);
  EXPECT_NEAR(share(kept.hessian, sums.displacement, towards), 1, 0.01);
  const Vector6d step = solve(kept, {}, sums.displacement);
  EXPECT_NEAR(step[2], 0.01, 1e-3);
}

TEST(NormalEquations, WhatColourSaysAlongAWallIsNotHeldBack) {
  const Sums sums = sums_of(wall(0.05));
  // Colour wants 3 cm along x, with a thousandth of the geometry's weight.
  NormalEquations colour;
  const double weight = 1e-3 * sums.displacement(0, 0);
  colour.hessian(0, 0) = weight;
  colour.right_hand_side[0] = 0.03 * weight;
  const Vector6d held = solve(sums.geometric, colour, sums.displacement);
  const Vector6d step =
      solve(discount_normal_noise(sums.geometric, sums.displacement, sums.disagreement), colour,
            sums.displacement);
  EXPECT_LT(held[0], 0.02);
  EXPECT_GT(step[0], 0.025);
}

TEST(NormalEquations, WithoutNoiseNothingIsTakenOff) {
  std::vector<Pair> pairs;
  std::mt19937 random(2);
  std::normal_distribution<double> any(0, 1);
  for (int i = 0; i < 500; ++i) {
    const Vector3d normal = Vector3d(any(random), any(random), any(random)).normalized();
    pairs.push_back(
        {{any(random), any(random), 2 + 0.3 * any(random)}, normal, normal, 0.01 * any(random)});
  }
  const Sums sums = sums_of(pairs);
  const NormalEquations kept =
      discount_normal_noise(sums.geometric, sums.displacement, sums.disagreement);
  EXPECT_LT((kept.hessian - sums.geometric.hessian).norm(), 1e-9 * sums.geometric.hessian.norm());
  EXPECT_LT((kept.right_hand_side - sums.geometric.right_hand_side).norm(),
            1e-9 * sums.geometric.right_hand_side.norm());
}

TEST(NormalEquations, TheOptimumOfGeometryAloneStaysWhereItWas) {
  std::vector<Pair> pairs = wall(0);
  for (std::size_t i = 0; i < pairs.size(); i += 3)
    pairs[i].model_normal = pairs[i].frame_normal = Vector3d(0.6, 0, 0.8);
  for (std::size_t i = 1; i < pairs.size(); i += 3)
    pairs[i].model_normal = pairs[i].frame_normal = Vector3d(0, 0.6, 0.8);
  const Sums sums = sums_of(pairs);
  const Vector6d step =
      solve(discount_normal_noise(sums.geometric, sums.displacement, 0.001), {}, sums.displacement);
  const Vector6d expected = solve(sums.geometric, {}, sums.displacement);
  EXPECT_LT((step - expected).norm(), 0.01 * expected.norm());
}

TEST(NormalEquations, ThePriorLeadsBackToWhatIsExpectedAlongAWallAndNowhereElse) {
  const Sums sums = sums_of(wall(0));
  const Vector6d beyond_expected = (Vector6d() << 0.04, -0.02, 0.03, 0, 0, 0.01).finished();
  const NormalEquations kept =
      discount_normal_noise(sums.geometric, sums.displacement, sums.disagreement);
  const double unit = 1e-4 * sums.displacement(0, 0);
  const Vector6d step = solve(kept, motion_prior(unit, beyond_expected), sums.displacement);
  EXPECT_NEAR(step[0], -0.04, 1e-3);
  EXPECT_NEAR(step[1], 0.02, 1e-3);
  EXPECT_NEAR(step[2], 0.01, 1e-3) << "towards the wall its points say more";
}

TEST(NormalEquations, WithoutPairsTheStepIsNone) {
  const NormalEquations kept = discount_normal_noise({}, Matrix6d::Zero(), 0);
  EXPECT_EQ(kept.hessian.norm(), 0);
  EXPECT_EQ(solve(kept, {}, Matrix6d::Zero()).norm(), 0);
}

TEST(NormalEquations, AMotionNobodyKnowsAnythingAboutStaysOut) {
  const Sums sums = sums_of(wall(0));
  const Vector6d step =
      solve(discount_normal_noise(sums.geometric, sums.displacement, sums.disagreement), {},
            sums.displacement);
  EXPECT_NEAR(step[2], 0.01, 1e-4);
  EXPECT_LT(std::hypot(step[0], step[1], step[5]), 1e-6) << "along the wall, about its normal";
}

// Pixels of an image that has moved by `step` and become brighter: its greys fall on both unknowns
// at once.
PhotometricSystem image_system(const Vector6d& step, const frame::Brightness& brightness,
                               double contrast) {
  std::mt19937 random(1);
  std::normal_distribution<double> number(0, 1);
  PhotometricSystem system;
  for (int i = 0; i < 500; ++i) {
    Vector6d row;
    for (int j = 0; j < 6; ++j) row[j] = 100 * number(random);
    const double grey = 120 + contrast * number(random);
    const Eigen::Vector2d by_brightness(-grey, -1);
    // Linear in the unknowns: residual(step, brightness) is zero at the truth.
    const double residual =
        -row.dot(step) - by_brightness.dot(Eigen::Vector2d(brightness.gain - 1, brightness.offset));
    system.motion.hessian += row * row.transpose();
    system.motion.right_hand_side -= residual * row;
    system.mixed += row * by_brightness.transpose();
    system.hessian += by_brightness * by_brightness.transpose();
    system.right_hand_side -= residual * by_brightness;
  }
  return system;
}

TEST(Brightness, IsToldFromMotion) {
  const Vector6d step = (Vector6d() << 0.01, -0.02, 0.005, 0.01, 0.003, -0.004).finished();
  const PhotometricSystem system = image_system(step, {1.25, 0}, 40);
  const NormalEquations motion = without_brightness(system, {});
  const Vector6d found = motion.hessian.ldlt().solve(motion.right_hand_side);
  EXPECT_LT((found - step).norm(), 0.01 * step.norm());
  const frame::Brightness after = brightness_after(system, {}, found);
  EXPECT_NEAR(after.gain, 1.25, 0.01);
  EXPECT_NEAR(after.offset, 0, 1);
}

// A map is less sharp than a frame: taken for a gain and an offset, its colours would fade from
// frame to frame.
TEST(Brightness, ContrastWithoutLightIsHardlyAGain) {
  const PhotometricSystem system = image_system(Vector6d::Zero(), {1.15, -18}, 20);
  const frame::Brightness after = brightness_after(system, {}, Vector6d::Zero());
  EXPECT_NEAR(after.gain, 1, 0.01);
  EXPECT_NEAR(after.offset, 0, 1);
}

TEST(Brightness, OfAFlatImageIsMostLikelyAGain) {
  const PhotometricSystem system = image_system(Vector6d::Zero(), {1, 10}, 0);
  const frame::Brightness after = brightness_after(system, {}, Vector6d::Zero());
  EXPECT_NEAR(120 * (after.gain - 1) + after.offset, 10, 0.1) << "what the pixels say";
  EXPECT_NEAR(after.offset, 0, 0.1);
}

TEST(Brightness, OfNoImageIsKept) {
  const frame::Brightness known{1.2, 3};
  const frame::Brightness after = brightness_after({}, known, Vector6d::Zero());
  EXPECT_EQ(after.gain, 1.2);
  EXPECT_EQ(after.offset, 3);
  EXPECT_EQ(without_brightness({}, known).hessian.norm(), 0);
}

}  // namespace
}  // namespace hermite::track::normal_equations_test
