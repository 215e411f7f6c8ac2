#include "core/dataset/trajectory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/dataset/temp_folder.h"

namespace hermite::dataset::trajectory_test {
namespace {

using testing::HasSubstr;

TEST(Trajectory, ReadsTheTumFormat) {
  const auto trajectory =
      parse_tum_trajectory("# comment\n1.5 1 2 3 0 0 0 1\n\n2.5 4 5 6 0.7071068 0 0 0.7071068\n");
  ASSERT_TRUE(trajectory.ok()) << trajectory.error().message;
  ASSERT_EQ(trajectory->size(), 2u);
  EXPECT_EQ((*trajectory)[0].timestamp_s, 1.5);
  EXPECT_EQ((*trajectory)[0].world_from_camera.translation, Eigen::Vector3d(1, 2, 3));
  // A quarter turn about x takes y to z.
  EXPECT_TRUE(((*trajectory)[1].world_from_camera * Eigen::Vector3d(0, 1, 0))
                  .isApprox(Eigen::Vector3d(4, 5, 7), 1e-6));
}

TEST(Trajectory, WritesWhatItReads) {
  Trajectory trajectory;
  for (int i = 0; i < 10; ++i) {
    Vector6d twist;
    twist << 0.1 * i, -0.2, 3, 0.3 * i, 0.1, -0.2;
    trajectory.push_back({1305031233.5 + i / 30.0, exp_se3(twist)});
  }
  const std::string text = format_tum_trajectory(trajectory);
  const auto again = parse_tum_trajectory(text);
  ASSERT_TRUE(again.ok()) << again.error().message;
  ASSERT_EQ(again->size(), trajectory.size());
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    EXPECT_NEAR((*again)[i].timestamp_s, trajectory[i].timestamp_s, 1e-6);
    const Rigid3 difference =
        inverse((*again)[i].world_from_camera) * trajectory[i].world_from_camera;
    EXPECT_LT(difference.translation.norm(), 1e-8);
    EXPECT_LT(angle_rad(difference.rotation), 1e-7);
  }
  EXPECT_EQ(format_tum_trajectory(*again), text)
      << "the text must be a fixed point, its hash names a run";
  EXPECT_THAT(text, HasSubstr("\n1305031233.500000 "));
}

TEST(Trajectory, AnyFiniteNumberFitsIntoALine) {
  const std::string text =
      format_tum_trajectory({{1e308, {Eigen::Quaterniond::Identity(), {-1e308, 1e308, 1e-308}}}});
  EXPECT_TRUE(parse_tum_trajectory(text).ok());
}

TEST(Trajectory, PosesBetweenTwoAreTheirMean) {
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitY()));
  const Trajectory trajectory = {
      {1.00, {}}, {1.01, {turned, {1, 2, 3}}}, {1.50, {turned, {4, 5, 6}}}};
  const auto quarter = pose_at(trajectory, 1.0025, 0.02);
  ASSERT_TRUE(quarter);
  EXPECT_LT((quarter->translation - Eigen::Vector3d(0.25, 0.5, 0.75)).norm(), 1e-9);
  EXPECT_NEAR(angle_rad(quarter->rotation), 0.05, 1e-9);
  EXPECT_EQ(pose_at(trajectory, 1.01, 0.02)->translation, Eigen::Vector3d(1, 2, 3))
      << "its own time";
}

TEST(Trajectory, PosesAtTheRimOfAGapAreTheNearOneOrNone) {
  const Trajectory trajectory = {{1.0, {Eigen::Quaterniond::Identity(), {1, 0, 0}}},
                                 {2.0, {Eigen::Quaterniond::Identity(), {2, 0, 0}}}};
  EXPECT_EQ(pose_at(trajectory, 1.01, 0.02)->translation.x(), 1);
  EXPECT_EQ(pose_at(trajectory, 1.99, 0.02)->translation.x(), 2);
  EXPECT_EQ(pose_at(trajectory, 0.99, 0.02)->translation.x(), 1);
  EXPECT_EQ(pose_at(trajectory, 2.01, 0.02)->translation.x(), 2);
  for (const double time_s : {0.9, 1.5, 2.1})
    EXPECT_FALSE(pose_at(trajectory, time_s, 0.02)) << time_s;
  EXPECT_FALSE(pose_at({}, 1, 0.02));
}

TEST(Trajectory, BadLinesAreNamed) {
  const char* const good = "0 0 0 0 0 0 0 1\n";
  const std::pair<const char*, const char*> cases[] = {
      {"1 2 3\n", "expected 8 numbers"},
      {"1 0 0 0 0 0 0 1 9\n", "expected 8 numbers"},
      {"1 0 0 nan 0 0 0 1\n", "field 4 is not a finite number"},
      {"1 0 0 inf 0 0 0 1\n", "field 4"},
      {"x 0 0 0 0 0 0 1\n", "field 1"},
      {"1 0 0 0 0 0 0 1.02\n", "length is not 1"},
      {"1 0 0 0 0 0 0 0\n", "length is not 1"},
      {"-1 0 0 0 0 0 0 1\n", "time runs backwards"},
  };
  for (const auto& [line, reason] : cases) {
    const auto trajectory = parse_tum_trajectory(std::string(good) + line);
    ASSERT_FALSE(trajectory.ok()) << line;
    EXPECT_EQ(trajectory.error().code, ErrorCode::kCorruptData);
    EXPECT_THAT(trajectory.error().message, HasSubstr("line 2"));
    EXPECT_THAT(trajectory.error().message, HasSubstr(reason));
  }
}

TEST(Trajectory, AlmostUnitQuaternionsAreNormalised) {
  const auto trajectory = parse_tum_trajectory("0 0 0 0 0 0 0 1.009\n");
  ASSERT_TRUE(trajectory.ok());
  EXPECT_DOUBLE_EQ((*trajectory)[0].world_from_camera.rotation.norm(), 1.0);
}

TEST(Trajectory, FilesAreNamedInErrors) {
  const TempFolder folder;
  folder.write("t.txt", "0 0 0 0 0 0 0 1\noops\n");
  EXPECT_THAT(read_tum_trajectory(folder.path("t.txt")).error().message,
              HasSubstr("t.txt: trajectory, line 2"));
  EXPECT_EQ(read_tum_trajectory(folder.path("none.txt")).error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace hermite::dataset::trajectory_test
