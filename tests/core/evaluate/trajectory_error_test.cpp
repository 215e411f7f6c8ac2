#include "core/evaluate/trajectory_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace hermite::evaluate {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

constexpr double kRounding = 1e-9;

Rigid3 at(double x, double y, double z) { return {Eigen::Quaterniond::Identity(), {x, y, z}}; }

// A curve that spans all three directions, with turning.
dataset::Trajectory wavy(int count) {
  dataset::Trajectory trajectory;
  for (int i = 0; i < count; ++i) {
    const double s = i / 30.0;
    const Eigen::AngleAxisd turn(0.4 * s, Vector3d(0.2, 1, -0.3).normalized());
    trajectory.push_back(
        {s, {Eigen::Quaterniond(turn), {std::sin(s), 0.5 * std::cos(1.7 * s), 0.3 * s}}});
  }
  return trajectory;
}

Rigid3 some_motion() {
  Vector6d twist;
  twist << 3, -2, 0.5, 0.7, -1.1, 2.0;
  return exp_se3(twist);
}

TEST(TrajectoryError, HandComputedAte) {
  // A square of side 2. Two opposite corners are 0.1 m too high and the others 0.1 m too low: by
  // symmetry no rigid motion helps, so every error is 0.1.
  const double t[] = {0, 1, 2, 3};
  const dataset::Trajectory truth = {
      {t[0], at(-1, -1, 0)}, {t[1], at(1, -1, 0)}, {t[2], at(1, 1, 0)}, {t[3], at(-1, 1, 0)}};
  const dataset::Trajectory estimate = {{t[0], at(-1, -1, 0.1)},
                                        {t[1], at(1, -1, -0.1)},
                                        {t[2], at(1, 1, 0.1)},
                                        {t[3], at(-1, 1, -0.1)}};
  const auto error = trajectory_error(estimate, truth);
  ASSERT_TRUE(error.ok()) << error.error().message;
  EXPECT_EQ(error->matched_count, 4);
  EXPECT_NEAR(error->ate_m.rmse, 0.1, kRounding);
  EXPECT_NEAR(error->ate_m.mean, 0.1, kRounding);
  EXPECT_NEAR(error->ate_m.median, 0.1, kRounding);
  EXPECT_NEAR(error->ate_m.max, 0.1, kRounding);
  EXPECT_LT(error->groundtruth_from_estimate.translation.norm(), kRounding);
  EXPECT_LT(angle_rad(error->groundtruth_from_estimate.rotation), kRounding);
}

TEST(TrajectoryError, ScaleIsNotAligned) {
  // The estimate is twice as large: corners at distance sqrt(2) from the centre land at 2 sqrt(2),
  // and stay sqrt(2) off.
  const dataset::Trajectory truth = {
      {0, at(-1, -1, 0)}, {1, at(1, -1, 0)}, {2, at(1, 1, 0)}, {3, at(-1, 1, 0)}};
  dataset::Trajectory estimate = truth;
  for (dataset::TimedPose& pose : estimate) pose.world_from_camera.translation *= 2;
  EXPECT_NEAR(trajectory_error(estimate, truth)->ate_m.rmse, std::sqrt(2.0), kRounding);
}

TEST(TrajectoryError, HandComputedRpe) {
  // Frame to frame the truth moves 1 m along x and does not turn; the estimate's second step is 1.2
  // m with a turn of 10 degrees.
  const double angle = 10 * M_PI / 180;
  const Rigid3 turned{Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitZ())), {2.2, 0, 0}};
  const dataset::Trajectory truth = {{0.0, at(0, 0, 0)}, {0.1, at(1, 0, 0)}, {0.2, at(2, 0, 0)}};
  const dataset::Trajectory estimate = {{0.0, at(0, 0, 0)}, {0.1, at(1, 0, 0)}, {0.2, turned}};
  const auto error = trajectory_error(estimate, truth);
  ASSERT_TRUE(error.ok());
  EXPECT_EQ(error->per_frame.pair_count, 2);
  EXPECT_NEAR(error->per_frame.translation_m.rmse, std::sqrt(0.2 * 0.2 / 2), kRounding);
  EXPECT_NEAR(error->per_frame.translation_m.max, 0.2, kRounding);
  EXPECT_NEAR(error->per_frame.rotation_deg.rmse, std::sqrt(100.0 / 2), 1e-6);
  EXPECT_NEAR(error->per_frame.rotation_deg.max, 10, 1e-6);
  EXPECT_FALSE(error->per_second) << "the trajectory is shorter than a second";
}

TEST(TrajectoryError, RpeOverOneSecondSumsDrift) {
  // 1 mm of drift a frame at 30 Hz is 30 mm a second.
  const dataset::Trajectory truth = wavy(91);
  dataset::Trajectory estimate;
  for (std::size_t i = 0; i < truth.size(); ++i)
    estimate.push_back({truth[i].timestamp_s,
                        {truth[i].world_from_camera.rotation,
                         truth[i].world_from_camera.translation +
                             Vector3d(0.001 * static_cast<double>(i), 0, 0)}});
  const auto error = trajectory_error(estimate, truth);
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->per_frame.translation_m.rmse, 0.001, kRounding);
  ASSERT_TRUE(error->per_second);
  EXPECT_EQ(error->per_second->pair_count, 61);
  EXPECT_NEAR(error->per_second->translation_m.rmse, 0.030, kRounding);
  EXPECT_NEAR(error->per_second->rotation_deg.max, 0, 1e-5);
}

TEST(TrajectoryError, FramesMissingInBetweenAreNoFrameToFramePairs) {
  const dataset::Trajectory estimate = wavy(10);
  dataset::Trajectory truth = estimate;
  truth.erase(truth.begin() + 4);
  const auto error = trajectory_error(estimate, truth);
  EXPECT_EQ(error->matched_count, 9);
  EXPECT_EQ(error->per_frame.pair_count, 7);
}

TEST(TrajectoryError, EachFrameHasItsErrors) {
  // The square of HandComputedAte, and its third camera is turned by 10 degrees: the positions
  // decide the alignment, so that stays its own.
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(10 * M_PI / 180, Vector3d::UnitY()));
  const dataset::Trajectory truth = {
      {0, at(-1, -1, 0)}, {1, at(1, -1, 0)}, {2, at(1, 1, 0)}, {3, at(-1, 1, 0)}};
  const dataset::Trajectory estimate = {
      {0, at(-1, -1, 0.1)}, {1, at(1, -1, -0.1)}, {2, {turn, {1, 1, 0.1}}}, {3, at(-1, 1, -0.1)}};
  dataset::Trajectory moved = estimate;
  for (dataset::TimedPose& pose : moved)
    pose.world_from_camera = some_motion() * pose.world_from_camera;
  const auto frames = trajectory_error(moved, truth)->frames;
  ASSERT_EQ(frames.size(), 4u);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    EXPECT_EQ(frames[i].index, static_cast<std::int64_t>(i));
    EXPECT_EQ(frames[i].timestamp_s, truth[i].timestamp_s);
    EXPECT_NEAR(frames[i].translation_m, 0.1, kRounding);
    EXPECT_NEAR(frames[i].rotation_deg, i == 2 ? 10 : 0, 1e-5);
  }
  EXPECT_FALSE(frames[0].step) << "nothing lies before it";
  ASSERT_TRUE(frames[1].step && frames[2].step && frames[3].step);
  EXPECT_NEAR(frames[1].step->translation_m, 0.2, kRounding);
  EXPECT_NEAR(frames[1].step->rotation_deg, 0, 1e-5);
  EXPECT_NEAR(frames[2].step->rotation_deg, 10, 1e-5);
  EXPECT_NEAR(frames[3].step->rotation_deg, 10, 1e-5);
}

TEST(TrajectoryError, FramesAreNumberedAsInTheEstimateAndStepOverNoGap) {
  const dataset::Trajectory estimate = wavy(10);
  dataset::Trajectory truth = estimate;
  truth.erase(truth.begin() + 4);
  const auto frames = trajectory_error(estimate, truth)->frames;
  ASSERT_EQ(frames.size(), 9u);
  EXPECT_EQ(frames[3].index, 3);
  EXPECT_EQ(frames[4].index, 5);
  EXPECT_FALSE(frames[4].step) << "pose 4 has no true one";
  EXPECT_TRUE(frames[5].step);
}

TEST(TrajectoryError, TheTableOfFramesLeavesOutWhatThereIsNot) {
  const std::vector<FrameError> frames = {{7, 1305031233.5, 0.0123, 0.25, std::nullopt},
                                          {8, 1305031233.75, 1, 2, FrameError::Step{3, 4}}};
  EXPECT_EQ(format_frame_errors_csv(frames),
            "index,timestamp_s,translation_error_m,rotation_error_deg,step_translation_error_m,"
            "step_rotation_error_deg\n"
            "7,1305031233.500000,0.012300000,0.250000,,\n"
            "8,1305031233.750000,1.000000000,2.000000,3.000000000,4.000000\n");
  EXPECT_EQ(format_frame_errors_csv({}).find('\n'), format_frame_errors_csv({}).size() - 1)
      << "only the names of the columns";
}

TEST(TrajectoryError, AnotherWorldFrameChangesNothing) {
  const dataset::Trajectory truth = wavy(60);
  dataset::Trajectory estimate = truth;
  for (std::size_t i = 0; i < estimate.size(); ++i) {
    Vector6d wobble;
    wobble << 0.01 * std::sin(i), 0.02 * std::cos(2.0 * static_cast<double>(i)), 0.01,
        0.01 * std::cos(i), 0, 0.005;
    estimate[i].world_from_camera = estimate[i].world_from_camera * exp_se3(wobble);
  }
  dataset::Trajectory moved = estimate;
  for (dataset::TimedPose& pose : moved)
    pose.world_from_camera = some_motion() * pose.world_from_camera;
  const auto before = trajectory_error(estimate, truth), after = trajectory_error(moved, truth);
  EXPECT_GT(before->ate_m.rmse, 0.005);
  EXPECT_NEAR(after->ate_m.rmse, before->ate_m.rmse, kRounding);
  EXPECT_NEAR(after->per_frame.translation_m.rmse, before->per_frame.translation_m.rmse, kRounding);
  EXPECT_NEAR(after->per_frame.rotation_deg.rmse, before->per_frame.rotation_deg.rmse, 1e-5);
  const Rigid3 recovered = after->groundtruth_from_estimate * some_motion();
  const Rigid3 difference = inverse(recovered) * before->groundtruth_from_estimate;
  EXPECT_LT(difference.translation.norm(), 1e-8);
  EXPECT_LT(angle_rad(difference.rotation), 1e-8);
}

TEST(TrajectoryError, AMirroredTrajectoryIsNotAlignedByAMirror) {
  const dataset::Trajectory truth = wavy(60);
  dataset::Trajectory mirrored = truth;
  for (dataset::TimedPose& pose : mirrored) pose.world_from_camera.translation.y() *= -1;
  const auto error = trajectory_error(mirrored, truth);
  EXPECT_GT(error->ate_m.rmse, 0.04);
  EXPECT_NEAR(error->groundtruth_from_estimate.rotation.toRotationMatrix().determinant(), 1,
              kRounding);
}

TEST(TrajectoryError, StraightLinesAndStillCamerasAlign) {
  dataset::Trajectory line, turned, still;
  for (int i = 0; i < 20; ++i) {
    line.push_back({i / 30.0, at(0.1 * i, 0.2 * i, -0.1 * i)});
    turned.push_back({i / 30.0, some_motion() * line.back().world_from_camera});
    still.push_back({i / 30.0, at(1, 2, 3)});
  }
  const auto error = trajectory_error(turned, line);
  ASSERT_TRUE(error.ok());
  EXPECT_NEAR(error->ate_m.max, 0, kRounding);
  EXPECT_NEAR(error->groundtruth_from_estimate.rotation.toRotationMatrix().determinant(), 1,
              kRounding);
  EXPECT_NEAR(trajectory_error(still, still)->ate_m.max, 0, kRounding);
}

TEST(TrajectoryError, OtherClocksDoNotMatch) {
  const dataset::Trajectory truth = wavy(30);
  dataset::Trajectory late = truth;
  for (dataset::TimedPose& pose : late) pose.timestamp_s += 100;
  const auto error = trajectory_error(late, truth);
  ASSERT_FALSE(error.ok());
  EXPECT_EQ(error.error().code, ErrorCode::kInvalidArgument);
  EXPECT_THAT(error.error().message, HasSubstr("only 0 of 30 estimated poses"));
  // 15 ms are within the gap, and shift every pose by less than a frame.
  for (dataset::TimedPose& pose : late) pose.timestamp_s += 0.015 - 100;
  EXPECT_EQ(trajectory_error(late, truth)->matched_count, 30);
}

TEST(TrajectoryError, TwoMatchesAreTooFew) {
  EXPECT_THAT(trajectory_error(wavy(2), wavy(30)).error().message, HasSubstr("only 2 of 2"));
  EXPECT_FALSE(trajectory_error({}, wavy(30)).ok());
  EXPECT_FALSE(trajectory_error(wavy(30), {}).ok());
}

TEST(TrajectoryError, NotFiniteOrUnorderedPosesAreRefused) {
  dataset::Trajectory broken = wavy(10);
  broken[3].world_from_camera.translation.y() = std::nan("");
  EXPECT_THAT(trajectory_error(broken, wavy(10)).error().message,
              HasSubstr("estimate: pose 3 is not finite"));
  dataset::Trajectory backwards = wavy(10);
  std::swap(backwards[2], backwards[3]);
  EXPECT_THAT(trajectory_error(wavy(10), backwards).error().message,
              HasSubstr("ground truth: time runs backwards at pose 3"));
}

TEST(TrajectoryError, MedianOfEvenAndOddCounts) {
  EXPECT_EQ(statistics_of({3, 1, 2}).median, 2);
  EXPECT_EQ(statistics_of({4, 1, 2, 3}).median, 2.5);
  EXPECT_NEAR(statistics_of({3, 4}).rmse, std::sqrt(12.5), kRounding);
  EXPECT_EQ(statistics_of({}).max, 0);
}

TEST(TrajectoryError, JsonHasTheNumbers) {
  const dataset::Trajectory truth = wavy(60);
  const auto json =
      nlohmann::json::parse(format_trajectory_error_json(*trajectory_error(truth, truth)));
  EXPECT_EQ(json["matched_poses"], 60);
  for (const char* key : {"ate_rmse_m", "ate_max_m", "rpe_translation_rmse_m",
                          "rpe_rotation_rmse_deg", "rpe_1s_translation_rmse_m"})
    EXPECT_NEAR(json.at(key).get<double>(), 0, 1e-5) << key;
  EXPECT_EQ(json["groundtruth_from_estimate"].size(), 16u);
}

}  // namespace
}  // namespace hermite::evaluate
