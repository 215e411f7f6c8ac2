#include "core/track/step_certainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite::track::step_certainty_test {
namespace {

// Information about one direction of a twist each.
StepWitness knows(const Vector6d& information, const Vector6d& step) {
  const Matrix6d hessian = information.asDiagonal();
  return {{hessian, hessian * step}, 1};
}

Vector6d filled(double value) { return Vector6d::Constant(value); }

TEST(StepCertainty, MoreInformationIsLessUncertain) {
  StepWitnesses few{knows(filled(1e6), Vector6d::Zero()), {}, {}}, many = few;
  many.depth.system.hessian *= 4;
  EXPECT_NEAR(step_covariance(few)(0, 0) / step_covariance(many)(0, 0), 4, 0.01);
}

TEST(StepCertainty, DoesNotDependOnTheUnitOfWeights) {
  StepWitnesses witnesses{
      knows(filled(1e6), Vector6d::Zero()), knows(filled(3e5), Vector6d::Zero()), {}},
      scaled = witnesses;
  for (StepWitness* witness : {&scaled.depth, &scaled.image}) {
    witness->system.hessian *= 1e3;
    witness->unit *= 1e3;
  }
  EXPECT_TRUE(step_covariance(witnesses).isApprox(step_covariance(scaled), 1e-9));
}

TEST(StepCertainty, AWeightOfTheImageIsAsAScaledSystem) {
  StepWitnesses weighted{knows(filled(1e6), Vector6d::Zero()),
                         knows(filled(3e5), Vector6d::Zero())},
      scaled = weighted;
  weighted.image_weight = 20;
  scaled.image.system.hessian *= 20;
  scaled.image.unit *= 20;
  // The prior, which counts as the larger unit, is negligible here.
  EXPECT_TRUE(step_covariance(weighted).isApprox(step_covariance(scaled), 1e-3));
  EXPECT_GT(step_covariance(weighted)(0, 0),
            step_covariance({weighted.depth, weighted.image})(0, 0))
      << "beyond what its certainty warrants, it makes the sum worse";
}

TEST(StepCertainty, AWitnessThatCountsTooMuchMakesItWorse) {
  // Of a noisy one as much as of a good one: the sum is worse than the good one alone.
  const StepWitness good = knows(filled(1e6), Vector6d::Zero());
  StepWitness noisy = good;
  noisy.unit = 100;
  EXPECT_GT(step_covariance({good, noisy, {}})(0, 0), 10 * step_covariance({good, {}, {}})(0, 0));
}

TEST(StepCertainty, IsFiniteWhereNothingHoldsTheCamera) {
  Vector6d wall = filled(0);
  wall[2] = wall[3] = wall[4] = 1e6;
  const Matrix6d covariance = step_covariance({knows(wall, Vector6d::Zero()), {}, {}});
  EXPECT_NEAR(std::sqrt(covariance(0, 0)), 0.3, 0.01) << "along the wall";
  EXPECT_LT(std::sqrt(covariance(2, 2)), 0.01) << "across it";
  EXPECT_TRUE(step_covariance({}).allFinite());
}

TEST(StepCertainty, WhatABlankWallSaysOfTheWayAlongItIsNoise) {
  // Points that all move as the camera does, and hold it along the wall only by the noise of their
  // normals.
  StepWitness wall = knows(filled(1e9), Vector6d::Zero());
  wall.system.hessian(0, 0) = 3e-5 * 1e9;
  const StepWitnesses blank{.depth = wall, .displacement = 1e9 * Matrix6d::Identity()};
  EXPECT_LT(std::sqrt(step_covariance({wall, {}, {}})(0, 0)), 0.02) << "as it says itself";
  EXPECT_NEAR(std::sqrt(step_covariance(blank)(0, 0)), 0.3, 0.01);
  EXPECT_LT(std::sqrt(step_covariance(blank)(2, 2)), 0.01) << "across it";
  StepWitnesses cornered = blank;
  cornered.corners = knows(filled(1e6), Vector6d::Zero());
  cornered.corner_weight = 1;
  EXPECT_LT(std::sqrt(step_covariance(cornered)(0, 0)), 0.01)
      << "followed corners are no such noise";
}

TEST(StepCertainty, NamesTheWitnessesThatDisagree) {
  const Vector6d aside = (Vector6d() << 0.03, 0, 0, 0, 0, 0).finished();
  const StepWitnesses witnesses{knows(filled(1e6), Vector6d::Zero()),
                                knows(filled(1e6), Vector6d::Zero()), knows(filled(1e6), aside)};
  const Contradiction apart = contradiction(witnesses);
  EXPECT_STREQ(apart.second, "corners");
  EXPECT_NEAR(apart.distance_m, 0.03, 1e-3);
  EXPECT_GT(apart.sigmas, 8);
}

TEST(StepCertainty, DisagreementAboutWhatOneDoesNotKnowIsNone) {
  Vector6d wall = filled(1e6);
  wall[0] = 0;
  const Vector6d aside = (Vector6d() << 0.03, 0, 0, 0, 0, 0).finished();
  EXPECT_LT(contradiction({knows(wall, Vector6d::Zero()), {}, knows(filled(1e6), aside)}).sigmas,
            1);
  EXPECT_EQ(contradiction({knows(wall, Vector6d::Zero()), {}, {}}).sigmas, 0) << "a single witness";
}

}  // namespace
}  // namespace hermite::track::step_certainty_test
