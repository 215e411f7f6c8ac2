#include "core/math/coasted_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite::coasted_motion_test {
namespace {

const Vector6d kTwist_per_s = (Vector6d() << 0.3, -0.1, 0.2, 0.4, 0.6, -0.5).finished();

TEST(CoastedMotion, ACameraThatIsNotSeenGoesOnLessAndLess) {
  for (const double nothing_s : {0.0, -1.0, std::nan("")}) {
    const CoastedMotion still = coasted_motion(kTwist_per_s, nothing_s);
    EXPECT_EQ(still.seen_from_now.translation, Eigen::Vector3d::Zero());
    EXPECT_EQ(still.position_sigma_m, 0);
  }
  const double speed_m_per_s = kTwist_per_s.head<3>().norm();
  const CoastedMotion soon = coasted_motion(kTwist_per_s, 0.033),
                      late = coasted_motion(kTwist_per_s, 1),
                      never = coasted_motion(kTwist_per_s, 1e6);
  EXPECT_LT((log_se3(soon.seen_from_now) - 0.033 * kTwist_per_s).norm(),
            0.05 * 0.033 * kTwist_per_s.norm());
  EXPECT_LT(soon.position_sigma_m, 0.2 * 0.033 * speed_m_per_s);
  EXPECT_LT(log_se3(late.seen_from_now).head<3>().norm(), 0.5 * speed_m_per_s);
  EXPECT_LT(log_se3(never.seen_from_now).head<3>().norm(), 0.51 * speed_m_per_s)
      << "it does not leave the house";
  EXPECT_GT(never.position_sigma_m, 1e5 * speed_m_per_s);
}

}  // namespace
}  // namespace hermite::coasted_motion_test
