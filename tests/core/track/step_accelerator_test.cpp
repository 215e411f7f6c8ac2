#include "core/track/step_accelerator.h"

#include <gtest/gtest.h>

namespace hermite::track::step_accelerator_test {
namespace {

const Matrix6d kAlike = Matrix6d::Identity();

Vector6d along(double x, double y) { return (Vector6d() << x, y, 0, 0, 0, 0).finished(); }

// Steps until what is proposed is below a hundred thousandth, where each proposal goes `share` of
// the way.
int steps_to(const Vector6d& goal, const Vector6d& share, bool accelerated) {
  Vector6d place = Vector6d::Zero();
  StepAccelerator accelerator;
  for (int step = 0; step < 100; ++step) {
    const Vector6d proposed = share.cwiseProduct(goal - place);
    if (proposed.norm() < 1e-5) return step;
    place += accelerated ? accelerator.next(proposed, kAlike) : proposed;
  }
  return 100;
}

TEST(StepAccelerator, TakesTheFirstStepAsItIsProposed) {
  StepAccelerator accelerator;
  EXPECT_EQ(accelerator.next(along(0.01, 0), kAlike), along(0.01, 0));
}

TEST(StepAccelerator, ForeseesWhereStepsThatHalveEnd) {
  StepAccelerator accelerator;
  accelerator.next(along(0.01, 0), kAlike);
  EXPECT_NEAR(accelerator.next(along(0.005, 0), kAlike).x(), 0.01, 1e-12) << "0.005 + 0.0025 + ...";
}

TEST(StepAccelerator, NeedsFewerStepsWhereDirectionsConvergeDifferently) {
  const Vector6d goal = along(0.01, 0.004), share = along(0.5, 0.8);
  const int plain = steps_to(goal, share, false), accelerated = steps_to(goal, share, true);
  EXPECT_EQ(plain, 9);
  EXPECT_LE(accelerated, 6);
}

TEST(StepAccelerator, ComesToRestWhereStepsGoTooFar) {
  const Vector6d goal = along(0.01, 0), share = along(1.6, 0);
  EXPECT_LT(steps_to(goal, share, true), steps_to(goal, share, false));
}

TEST(StepAccelerator, TakesWhatIsProposedWhereTheLastStepTellsNothing) {
  StepAccelerator accelerator;
  accelerator.next(along(0.01, 0), kAlike);
  EXPECT_EQ(accelerator.next(along(0.01, 0), kAlike), along(0.01, 0)) << "no end in sight";
  accelerator.reset();
  EXPECT_EQ(accelerator.next(along(0.005, 0), kAlike), along(0.005, 0)) << "another problem";
  EXPECT_EQ(accelerator.next(along(0.0045, 0), kAlike), along(0.0045, 0)) << "ten times as far";
  StepAccelerator without_points;
  without_points.next(along(0.01, 0), Matrix6d::Zero());
  EXPECT_EQ(without_points.next(along(0.005, 0), Matrix6d::Zero()), along(0.005, 0));
}

}  // namespace
}  // namespace hermite::track::step_accelerator_test
