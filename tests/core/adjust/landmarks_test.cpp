#include "core/adjust/landmarks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "core/adjust/features.h"
#include "core/synthetic/synthetic_camera.h"
#include "tests/core/adjust/point_world.h"

namespace hermite::adjust {
namespace {

// Keyframes every `step_deg` from 0 to `end_deg`, and which point of the world every landmark truly
// is.
struct Walk {
  test::PointWorld world{3000};
  SparseMap map = test::empty_map();
  std::vector<InsertResult> results;
  std::vector<test::View> views;

  void go(double end_deg, double step_deg) {
    for (double yaw_deg = 0; yaw_deg <= end_deg; yaw_deg += step_deg)
      add(test::looking(yaw_deg, 0.1));
  }
  void add(const Rigid3& pose, const Rigid3& stated_error = {}) {
    views.push_back(world.view(pose, test::kViewNoise, views.size() + 1));
    results.push_back(insert_keyframe(map, test::keyframe_of(views.back(), pose * stated_error)));
  }
  // Observations of another point than the landmark's first one.
  int wrong_count() const {
    int wrong = 0;
    for (const Landmark& landmark : map.landmarks)
      for (const Observation& observation : landmark.observations)
        wrong += point(observation) != point(landmark.observations.front());
    return wrong;
  }
  std::size_t point(const Observation& observation) const {
    return views[observation.keyframe].point_of_feature[observation.feature];
  }
};

TEST(InsertKeyframe, TheFirstOneMakesALandmarkOfEveryFeatureWithDepth) {
  const test::PointWorld world(1000);
  test::View view = world.view(Rigid3());
  view.features[4].depth_m = 0;
  view.features[5].depth_m = std::numeric_limits<float>::quiet_NaN();
  SparseMap map = test::empty_map();
  const InsertResult result = insert_keyframe(map, test::keyframe_of(view, Rigid3()));
  EXPECT_EQ(result.keyframe, 0u);
  EXPECT_EQ(result.matched_count, 0);
  EXPECT_TRUE(result.repeated.empty());
  EXPECT_EQ(result.created.size(), view.features.size() - 2);
  EXPECT_EQ(map.keyframes[0].landmark_of_feature[4], kNoLandmark);
  for (const Landmark& landmark : map.landmarks) {
    const std::size_t point = view.point_of_feature[landmark.observations[0].feature];
    // Pixels are floats.
    EXPECT_LT((landmark.position_in_submap_m - world.points[point].position_m).norm(), 1e-5);
  }
}

TEST(InsertKeyframe, TracksLandmarksOverKeyframes) {
  Walk walk;
  walk.go(30, 5);
  EXPECT_EQ(walk.wrong_count(), 0);
  for (std::size_t i = 1; i < walk.results.size(); ++i) {
    // 5 of 62 degrees leave the image; noise and bits cost some of the others.
    EXPECT_GT(walk.results[i].matched_count,
              static_cast<int>(walk.views[i].features.size() * 7 / 10));
    EXPECT_EQ(walk.results[i].matched_count + static_cast<int>(walk.results[i].created.size()),
              static_cast<int>(walk.views[i].features.size()));
  }
  EXPECT_TRUE(
      std::any_of(walk.map.landmarks.begin(), walk.map.landmarks.end(),
                  [](const Landmark& landmark) { return landmark.observations.size() == 7; }));
}

TEST(InsertKeyframe, SaysWhatWasSeenForTheSecondTime) {
  Walk walk;
  walk.go(10, 5);
  EXPECT_EQ(walk.results[1].repeated.size(),
            static_cast<std::size_t>(walk.results[1].matched_count));
  for (const std::uint32_t landmark : walk.results[2].repeated) {
    const auto& observations = walk.map.landmarks[landmark].observations;
    ASSERT_EQ(observations.size(), 2u);
    EXPECT_EQ(observations[1].keyframe, 2u);
  }
}

TEST(InsertKeyframe, APoseThatIsSomePixelsOffDoesNotMatter) {
  Walk walk;
  walk.add(test::looking(0));
  walk.add(test::looking(4),
           exp_se3((Vector6d() << 0.005, 0.004, -0.005, 0.004, -0.005, 0.006).finished()));
  EXPECT_GT(walk.results[1].matched_count,
            static_cast<int>(walk.views[1].features.size() * 7 / 10));
  EXPECT_EQ(walk.wrong_count(), 0);
}

TEST(InsertKeyframe, TheFormerKeyframesAreFoundThroughCovisibility) {
  Walk walk;
  walk.go(25, 5);
  // Back again: the last three keyframes look 15 to 25 degrees to the side.
  walk.add(test::looking(0, 0.1));
  const InsertResult& last = walk.results.back();
  EXPECT_GT(last.matched_count, static_cast<int>(walk.views.back().features.size() * 8 / 10));
  const std::vector<Covisible> neighbours = covisible(walk.map, last.keyframe);
  ASSERT_FALSE(neighbours.empty());
  EXPECT_EQ(neighbours.front().keyframe, 0u);
}

TEST(InsertKeyframe, APlaceFoundAgainIsJoinedWhenAskedFor) {
  Walk walk;
  walk.add(test::looking(0));
  for (double yaw_deg : {90, 180, 270}) walk.add(test::looking(yaw_deg));  // share nothing
  const test::View view = walk.world.view(test::looking(2), test::kViewNoise, 99);
  SparseMap joined = walk.map;
  EXPECT_EQ(insert_keyframe(walk.map, test::keyframe_of(view, test::looking(2))).matched_count, 0);
  EXPECT_GT(insert_keyframe(joined, test::keyframe_of(view, test::looking(2)), {0}).matched_count,
            100);
}

TEST(InsertKeyframe, ObservationsCrossSubmaps) {
  Walk walk;
  walk.add(test::looking(0));
  walk.map.world_from_submap.push_back(test::looking(3, 0.2));
  walk.views.push_back(walk.world.view(test::looking(5), test::kViewNoise, 7));
  const Rigid3 in_submap = inverse(walk.map.world_from_submap[1]) * test::looking(5);
  const InsertResult result =
      insert_keyframe(walk.map, test::keyframe_of(walk.views.back(), in_submap, 1));
  EXPECT_GT(result.matched_count, 100);
  EXPECT_EQ(walk.wrong_count(), 0);
  for (const std::uint32_t landmark : result.created) {
    const std::size_t point = walk.point(walk.map.landmarks[landmark].observations[0]);
    EXPECT_EQ(walk.map.landmarks[landmark].submap, 1u);
    // One standard deviation of depth noise is 2.5 cm at 3 m.
    EXPECT_LT((position_in_world_m(walk.map, walk.map.landmarks[landmark]) -
               walk.world.points[point].position_m)
                  .norm(),
              5 * 0.07);
  }
}

// From images: the landmarks of a rendered room are matched where they truly are.
TEST(InsertKeyframe, MatchesOfARenderedRoomReprojectWell) {
  const Camera camera = test::point_camera();
  const synthetic::SyntheticRoom room(synthetic::RoomScene::kRoom);
  SparseMap map = test::empty_map();
  for (const double time_s : {0.0, 0.3}) {
    const Rigid3 pose = synthetic::synthetic_pose(time_s, 1);
    synthetic::RoomView view = room.render(camera, pose);
    Keyframe keyframe;
    keyframe.submap_from_camera = pose;
    keyframe.features =
        detect_features({time_s, std::move(view.depth), std::move(view.color)}, camera);
    insert_keyframe(map, std::move(keyframe));
  }
  int matched = 0, near = 0;
  for (const Landmark& landmark : map.landmarks) {
    if (landmark.observations.size() != 2) continue;
    const Keyframe& keyframe = map.keyframes[1];
    const Feature& feature = keyframe.features[landmark.observations[1].feature];
    const Eigen::Vector3d in_camera =
        inverse(keyframe.submap_from_camera) * landmark.position_in_submap_m;
    ++matched;
    near += (camera.project(in_camera) - feature.pixel_px.cast<double>()).norm() <
            2 * octave_scale(feature.octave);
  }
  EXPECT_GT(matched, 250);
  EXPECT_GT(near, matched * 85 / 100);
}

}  // namespace
}  // namespace hermite::adjust
