#include "core/track/odometry_step.h"

#include <gtest/gtest.h>

namespace hermite::track::odometry_step_test {
namespace {

// A wall across z whose normals are noisy: its points seem to face along the wall by a mean squared
// cosine of 0.02. Pairs that pass the gate of angles explain 0.01 of it as noise, all pairs near
// each other 0.03. The image says nothing.
OdometrySums noisy_wall(double gradient_share) {
  OdometrySums sums;
  sums.displacement.setIdentity();
  sums.geometric.hessian.setIdentity();
  sums.geometric.hessian(0, 0) = 0.02;
  sums.disagreement = 4 * 0.01;
  sums.near_disagreement = 4 * 0.03;
  sums.gradient_share = gradient_share;
  return sums;
}

double known_along_the_wall(double gradient_share, const StepTerms& terms) {
  return step_systems(noisy_wall(gradient_share), {}, Rigid3{}, terms).geometric.hessian(0, 0);
}

const StepTerms kFinest{true, true, std::nullopt, nullptr};

TEST(OdometryStep, BesideASharpImageAllDisagreementOfNormalsIsNoise) {
  EXPECT_EQ(known_along_the_wall(0.8, kFinest), 0);
}

TEST(OdometryStep, BesideABlurredImageOnlyThatOfAcceptedPairsIsNoise) {
  EXPECT_NEAR(known_along_the_wall(0.1, kFinest), 0.01, 1e-12);
}

TEST(OdometryStep, BetweenTheTwoItGrowsWithTheShareOfGradients) {
  EXPECT_NEAR(known_along_the_wall(0.325, kFinest), 0.005, 1e-12);
}

TEST(OdometryStep, BeforeTheFrameIsAlignedNormalsDisagreeForOtherReasons) {
  const StepTerms coarse{true, false, std::nullopt, nullptr};
  EXPECT_NEAR(known_along_the_wall(0.8, coarse), 0.01, 1e-12);
}

TEST(OdometryStep, WithoutAnImageAllOfItIsNoise) {
  const StepTerms alone{true, true, Rigid3{}, nullptr};
  EXPECT_EQ(known_along_the_wall(0.1, alone), 0);
}

TEST(OdometryStep, AsEvidenceDepthNeverKnowsMoreThanBeyondAllOfIt) {
  const StepSystems systems = step_systems(noisy_wall(0.1), {}, Rigid3{}, kFinest);
  EXPECT_EQ(systems.witnesses.depth.system.hessian(0, 0), 0);
}

// A frame with a surface in this share of its pixels. A residual of the image that is as likely as
// one of depth weighs a thousandth of it.
OdometrySums frame_with_surface(double share) {
  OdometrySums sums = noisy_wall(0.8);
  sums.pixel_count = 1000;
  sums.surface_count = sums.geometric_count = sums.photometric_count = share * sums.pixel_count;
  sums.geometric_base = sums.geometric_error_m2 = sums.geometric_count;
  sums.photometric_squares = 1e-3 * sums.photometric_count;
  sums.photometric.motion.hessian.setIdentity();
  sums.photometric.hessian(1, 1) = 1;
  return sums;
}

double weight_of_image(double surface_share) {
  const StepSystems systems =
      step_systems(frame_with_surface(surface_share), {}, Rigid3{}, kFinest);
  EXPECT_EQ(systems.photometric.hessian(0, 0), systems.witnesses.image_weight);
  EXPECT_EQ(systems.witnesses.image.system.hessian(0, 0), 1) << "the evidence is the same";
  return systems.witnesses.image_weight;
}

TEST(OdometryStep, TheImageCountsMoreWhereDepthIsSparse) {
  EXPECT_EQ(weight_of_image(0.5), 1);
  EXPECT_NEAR(weight_of_image(0.1), 100, 1e-9) << "a tenth of what is as certain as depth";
  EXPECT_GT(weight_of_image(0.2), 1);
  EXPECT_LT(weight_of_image(0.2), 100);
}

}  // namespace
}  // namespace hermite::track::odometry_step_test
