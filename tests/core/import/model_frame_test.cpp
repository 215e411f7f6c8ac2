#include "core/import/model_frame.h"

#include <gtest/gtest.h>

#include <limits>

namespace hermite::imports {
namespace {

TEST(ModelFrame, WhatIsUpInAFilePointsAgainstYInTheWorld) {
  const Eigen::Vector3f up(0, -1, 0);
  EXPECT_EQ(turned_from(UpAxis::kY, {0, 1, 0}), up);
  EXPECT_EQ(turned_from(UpAxis::kZ, {0, 0, 1}), up);
  EXPECT_EQ(turned_from(UpAxis::kMinusY, {0, -1, 0}), up);
  const Eigen::Vector3f some(1, 2, 3);
  EXPECT_EQ(output::from_y_up(output::y_up(some)), some);
  EXPECT_EQ(output::from_z_up(output::z_up(some)), some);
}

TEST(ModelFrame, NormalsAreUnitOrNone) {
  EXPECT_EQ(unit_or_zero({0, 3, 4}), Eigen::Vector3f(0, 0.6f, 0.8f));
  EXPECT_EQ(unit_or_zero({0, 0, 0}), Eigen::Vector3f::Zero());
  EXPECT_EQ(unit_or_zero({0, std::numeric_limits<float>::quiet_NaN(), 4}), Eigen::Vector3f::Zero());
}

}  // namespace
}  // namespace hermite::imports
