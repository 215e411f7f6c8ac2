#include "core/evaluate/depth_consistency.h"
#include "core/source/open_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace hermite::evaluate {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Depth is rounded to 0.2 mm, and windows round off what is not plane.
constexpr double kTrue_m = 0.0003;

std::unique_ptr<dataset::Sequence> synthetic(const std::string& options) {
  return *source::open_sequence("synthetic:width=96,height=72," + options);
}

// Every frame farther along (1, 1, 1) than it was, by that much in each direction: walls, floor and
// ceiling all come off by that.
dataset::Trajectory drifting(dataset::Trajectory trajectory, double per_frame_m) {
  for (std::size_t i = 0; i < trajectory.size(); ++i)
    trajectory[i].world_from_camera.translation +=
        static_cast<double>(i) * Eigen::Vector3d::Constant(per_frame_m);
  return trajectory;
}

ConsistencyOptions spacings(std::vector<std::int64_t> frames) {
  ConsistencyOptions options;
  options.spacings = std::move(frames);
  return options;
}

// A slanted wall, seen through a lens by a camera that turns 2 degrees a frame; every third frame
// is broken.
class Wall : public dataset::Sequence {
 public:
  explicit Wall(const Camera& camera) : camera_(camera) {
    for (int i = 0; i < 12; ++i) {
      const Eigen::AngleAxisd turn(i * 2 * M_PI / 180, Eigen::Vector3d::UnitY());
      trajectory_.push_back({i / 30.0, {Eigen::Quaterniond(turn), {0.01 * i, 0, 0}}});
    }
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) rays_.push_back(straight_ray(x, y));
  }
  std::string format() const override { return "wall"; }
  std::string name() const override { return "the wall"; }
  const Camera& camera() const override { return camera_; }
  double frame_rate_hz() const override { return 30; }
  std::int64_t frame_count() const override {
    return static_cast<std::int64_t>(trajectory_.size());
  }
  double timestamp_s(std::int64_t index) const override {
    return trajectory_[static_cast<std::size_t>(index)].timestamp_s;
  }
  const dataset::Trajectory& groundtruth() const override { return trajectory_; }

  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    if (index % 6 == 2) return Error{ErrorCode::kCorruptData, "torn"};
    if (index % 6 == 5) return dataset::RecordedFrame{timestamp_s(index), DepthImage(8, 8), {}};
    const Rigid3& world_from_camera =
        trajectory_[static_cast<std::size_t>(index)].world_from_camera;
    const Eigen::Vector3d normal(0.3, 0.2, 1);  // normal.p = 2 is the wall
    dataset::RecordedFrame frame{timestamp_s(index), DepthImage(camera_.width, camera_.height), {}};
    for (std::size_t i = 0; i < rays_.size(); ++i) {
      const double depth_m = (2 - normal.dot(world_from_camera.translation)) /
                             normal.dot(world_from_camera.rotation * rays_[i]);
      frame.depth.pixels[i] =
          static_cast<std::uint16_t>(std::lround(depth_m * camera_.depth_units_per_metre));
    }
    return frame;
  }

 private:
  // The direction that the lens bends to this pixel.
  Eigen::Vector3d straight_ray(int x, int y) const {
    const Eigen::Vector2d bent((x - camera_.cx) / camera_.fx, (y - camera_.cy) / camera_.fy);
    Eigen::Vector2d straight = bent;
    for (int i = 0; i < 30; ++i)
      straight += bent - camera_.distortion.apply(straight.x(), straight.y());
    return {straight.x(), straight.y(), 1};
  }

  const Camera camera_;
  dataset::Trajectory trajectory_;
  std::vector<Eigen::Vector3d> rays_;  // of the pixels, row by row
};

const Camera kBentCamera{320, 240, 262.5, 262.5, 159.5, 119.5, 5000, {0.2, -0.1, 0.002, -0.002, 0}};

TEST(DepthConsistency, TruePosesAgree) {
  const auto sequence = synthetic("frames=16,rate=15");
  const auto result = depth_consistency(*sequence, {sequence->groundtruth()}, spacings({1, 4, 10}));
  ASSERT_TRUE(result.ok()) << result.error().message;
  ASSERT_THAT(*result, SizeIs(3));
  for (const SpacingConsistency& spacing : *result) {
    EXPECT_EQ(spacing.tried_count, 16 - spacing.spacing_frames);
    EXPECT_EQ(spacing.pair_count, spacing.tried_count);
    ASSERT_THAT(spacing.trajectories, SizeIs(1));
    EXPECT_LT(spacing.trajectories[0].median_m, kTrue_m);
    EXPECT_LT(spacing.trajectories[0].rms_m, 0.005) << "a few points lie at edges";
    EXPECT_EQ(spacing.trajectories[0].better_share, 0) << "than nothing";
  }
  EXPECT_GT((*result)[0].trajectories[0].overlap, (*result)[2].trajectories[0].overlap);
}

TEST(DepthConsistency, AShiftBetweenTheFramesIsTheDistance) {
  const auto sequence = synthetic("frames=12,rate=15,scene=bare");
  const auto result =
      depth_consistency(*sequence, {drifting(sequence->groundtruth(), 0.002)}, spacings({1, 3, 8}));
  for (const SpacingConsistency& spacing : *result) {
    ASSERT_GT(spacing.pair_count, 0);
    const double expected_m = 0.002 * static_cast<double>(spacing.spacing_frames);
    EXPECT_NEAR(spacing.trajectories[0].median_m, expected_m, kTrue_m) << spacing.spacing_frames;
    EXPECT_NEAR(spacing.trajectories[0].rms_m, expected_m, 0.001) << spacing.spacing_frames;
  }
}

TEST(DepthConsistency, TheBetterOfTwoIsNamed) {
  const auto sequence = synthetic("frames=12,rate=15");
  const dataset::Trajectory truth = sequence->groundtruth(), drifted = drifting(truth, 0.002);
  const SpacingConsistency spacing =
      depth_consistency(*sequence, {drifted, truth}, spacings({4}))->at(0);
  ASSERT_THAT(spacing.trajectories, SizeIs(2));
  EXPECT_EQ(spacing.pair_count, 8);
  EXPECT_EQ(spacing.trajectories[0].better_share, 0);
  EXPECT_EQ(spacing.trajectories[1].better_share, 1);
  EXPECT_GT(spacing.trajectories[0].median_m, 10 * spacing.trajectories[1].median_m);
  // Nobody wins against himself.
  const SpacingConsistency same =
      depth_consistency(*sequence, {truth, truth}, spacings({4}))->at(0);
  for (const Consistency& trajectory : same.trajectories) EXPECT_EQ(trajectory.better_share, 0);
}

TEST(DepthConsistency, AnotherWorldFrameChangesNothing) {
  const auto sequence = synthetic("frames=6,rate=15");
  dataset::Trajectory moved = sequence->groundtruth();
  for (dataset::TimedPose& pose : moved)
    pose.world_from_camera =
        Wall(kBentCamera).groundtruth().back().world_from_camera * pose.world_from_camera;
  const auto both = depth_consistency(*sequence, {sequence->groundtruth(), moved}, spacings({2}))
                        ->at(0)
                        .trajectories;
  EXPECT_NEAR(both[0].median_m, both[1].median_m, 1e-9);
  EXPECT_NEAR(both[0].overlap, both[1].overlap, 1e-3);
}

TEST(DepthConsistency, FramesThatSeeNothingInCommonAreNoPairs) {
  // Half a lap is 5 s: the camera looks at the opposite side.
  const auto sequence = synthetic("frames=8,rate=1,scene=bare");
  const auto result =
      depth_consistency(*sequence, {sequence->groundtruth()}, spacings({5, 8, 1000}));
  ASSERT_THAT(*result, SizeIs(3));
  EXPECT_EQ((*result)[0].tried_count, 3);
  EXPECT_EQ((*result)[1].tried_count, 0) << "longer than the sequence";
  for (const SpacingConsistency& spacing : *result) {
    EXPECT_EQ(spacing.pair_count, 0);
    EXPECT_THAT(spacing.trajectories, IsEmpty());
  }
}

TEST(DepthConsistency, TheLensIsStraightened) {
  const Wall wall(kBentCamera);
  const auto straightened = depth_consistency(wall, {wall.groundtruth()}, spacings({4}))->at(0);
  ASSERT_GT(straightened.pair_count, 0);
  EXPECT_LT(straightened.trajectories[0].median_m, 0.0005)
      << "depths are those of the nearest pixel";
  class Denied : public Wall {
   public:
    Denied() : Wall(kBentCamera) { pinhole_.distortion = {}; }
    const Camera& camera() const override { return pinhole_; }

   private:
    Camera pinhole_ = kBentCamera;
  };
  EXPECT_GT(depth_consistency(Denied(), {wall.groundtruth()}, spacings({4}))
                ->at(0)
                .trajectories[0]
                .median_m,
            0.0015);
}

TEST(DepthConsistency, BrokenFramesAndMissingPosesAreLeftOut) {
  const Wall wall(kBentCamera);
  // Pairs (0, 3), (1, 4), ... (8, 11): those that begin or end at 2, 5, 8 or 11 are gone.
  EXPECT_EQ(depth_consistency(wall, {wall.groundtruth()}, spacings({3}))->at(0).tried_count, 6);
  dataset::Trajectory holes = wall.groundtruth();
  holes.erase(holes.begin());
  EXPECT_EQ(depth_consistency(wall, {wall.groundtruth(), holes}, spacings({3}))->at(0).tried_count,
            5);
}

TEST(DepthConsistency, LongSequencesAreThinned) {
  const auto sequence = synthetic("frames=20,rate=15,scene=bare");
  ConsistencyOptions options = spacings({1, 9});
  options.max_first_frames = 7;
  const auto result = depth_consistency(*sequence, {sequence->groundtruth()}, options);
  EXPECT_EQ((*result)[0].tried_count, 7);  // 0, 3, ... 18
  EXPECT_EQ((*result)[1].tried_count, 4);  // 0, 3, 6, 9
}

TEST(DepthConsistency, WhatCannotBeMeasuredIsSaid) {
  const Wall wall(kBentCamera);
  const dataset::Trajectory& truth = wall.groundtruth();
  const auto problem = [&](const std::vector<dataset::Trajectory>& trajectories,
                           std::vector<std::int64_t> frames) {
    const auto result = depth_consistency(wall, trajectories, spacings(std::move(frames)));
    return result.ok() ? "none" : result.error().message;
  };
  EXPECT_THAT(problem({truth}, {4, 0}), HasSubstr("a spacing of 0 frames"));
  EXPECT_THAT(problem({truth}, {-3}), HasSubstr("a spacing of -3 frames"));
  EXPECT_THAT(problem({truth}, {}), HasSubstr("needs a trajectory and a spacing"));
  EXPECT_THAT(problem({}, {4}), HasSubstr("needs a trajectory and a spacing"));
  EXPECT_THAT(problem({truth, {}}, {4}),
              HasSubstr("trajectory 2 has no pose for any frame of the wall"));
  dataset::Trajectory broken = truth;
  broken[3].world_from_camera.translation.x() = std::nan("");
  EXPECT_THAT(problem({broken}, {4}), HasSubstr("trajectory 1: pose 3 is not finite"));
}

TEST(DepthConsistency, JsonHasTheNumbersOfSpacingsThatHaveAny) {
  const std::vector<SpacingConsistency> spacings = {
      {5, 20, 10, {{0.001, 0.002, 0.5, 0.75}, {0.003, 0.004, 0.5, 0.25}}}, {80, 7, 0, {}}};
  const auto json = nlohmann::json::parse(
      format_consistency_json(spacings, {"estimate", "groundtruth"}))["consistency"];
  ASSERT_EQ(json.size(), 2u);
  EXPECT_EQ(json[0]["spacing_frames"], 5);
  EXPECT_EQ(json[0]["pairs_tried"], 20);
  EXPECT_EQ(json[0]["pairs"], 10);
  EXPECT_EQ(json[0]["estimate_median_m"], 0.001);
  EXPECT_EQ(json[0]["estimate_rms_m"], 0.002);
  EXPECT_EQ(json[0]["groundtruth_overlap"], 0.5);
  EXPECT_EQ(json[0]["groundtruth_better_share"], 0.25);
  EXPECT_EQ(json[1],
            nlohmann::json::parse(R"({"spacing_frames": 80, "pairs_tried": 7, "pairs": 0})"));
  const auto alone = nlohmann::json::parse(
      format_consistency_json({{5, 20, 10, {{0.001, 0.002, 0.5, 0}}}}, {"estimate"}));
  EXPECT_FALSE(alone["consistency"][0].contains("estimate_better_share"));
}

}  // namespace
}  // namespace hermite::evaluate
