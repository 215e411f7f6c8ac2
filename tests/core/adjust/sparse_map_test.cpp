#include "core/adjust/sparse_map.h"

#include <gtest/gtest.h>

#include "core/adjust/bundle_noise.h"
#include "tests/core/adjust/point_world.h"

namespace hermite::adjust {
namespace {

// Keyframes of 20 features each at 2 m; landmark l of `first` and on is seen by both keyframes'
// feature l where the test says so.
SparseMap map_of(std::uint32_t keyframe_count, std::uint32_t landmark_count) {
  SparseMap map = test::empty_map();
  std::mt19937_64 random(1);
  for (std::uint32_t k = 0; k < keyframe_count; ++k) {
    Keyframe keyframe;
    keyframe.features.resize(landmark_count);
    for (Feature& feature : keyframe.features) {
      feature.depth_m = 2;
      feature.descriptor = test::random_descriptor(random);
    }
    keyframe.landmark_of_feature.assign(landmark_count, kNoLandmark);
    map.keyframes.push_back(keyframe);
  }
  map.landmarks.resize(landmark_count);
  return map;
}

// Both directions name each other, and nothing else does.
void expect_consistent(const SparseMap& map) {
  std::size_t named = 0, listed = 0;
  for (const Keyframe& keyframe : map.keyframes)
    for (const std::int32_t landmark : keyframe.landmark_of_feature)
      named += landmark != kNoLandmark;
  for (std::size_t l = 0; l < map.landmarks.size(); ++l)
    for (const Observation& observation : map.landmarks[l].observations) {
      ++listed;
      EXPECT_EQ(map.keyframes[observation.keyframe].landmark_of_feature[observation.feature],
                static_cast<std::int32_t>(l));
    }
  EXPECT_EQ(named, listed);
}

TEST(SparseMap, PosesAndPositionsFollowTheirSubmap) {
  SparseMap map = map_of(1, 1);
  map.world_from_submap[0] = test::looking(90);
  map.keyframes[0].submap_from_camera.translation = {0, 0, 2};
  map.landmarks[0].position_in_submap_m = {0, 0, 3};
  EXPECT_LT(
      (world_from_camera(map, map.keyframes[0]).translation - Eigen::Vector3d(2, 0, 0)).norm(),
      1e-12);
  EXPECT_LT((position_in_world_m(map, map.landmarks[0]) - Eigen::Vector3d(3, 0, 0)).norm(), 1e-12);
}

TEST(AddObservation, KeepsBothDirectionsAndTheOrderOfKeyframes) {
  SparseMap map = map_of(3, 4);
  add_observation(map, 2, {2, 0});
  add_observation(map, 2, {0, 3});
  add_observation(map, 2, {1, 1});
  EXPECT_EQ(map.landmarks[2].observations, (std::vector<Observation>{{0, 3}, {1, 1}, {2, 0}}));
  expect_consistent(map);
}

TEST(AddObservation, TheDescriptorIsThatOfTheMajority) {
  SparseMap map = map_of(4, 1);
  std::mt19937_64 random(2);
  const Descriptor usual = map.keyframes[1].features[0].descriptor;
  for (std::uint32_t k : {2u, 3u})
    map.keyframes[k].features[0].descriptor = test::with_flipped_bits(usual, 20, random);
  for (std::uint32_t k = 0; k < 4; ++k) add_observation(map, 0, {k, 0});
  EXPECT_LE(hamming(map.landmarks[0].descriptor, usual), 20);
}

TEST(PositionSigma, IsThatOfTheNearestView) {
  SparseMap map = map_of(3, 1);
  EXPECT_EQ(position_sigma_m(map, map.landmarks[0]), 0);
  map.keyframes[0].features[0].depth_m = 3;
  map.keyframes[1].features[0].depth_m = 1.5f;
  map.keyframes[2].features[0].depth_m = 0;
  for (std::uint32_t k = 0; k < 3; ++k) add_observation(map, 0, {k, 0});
  EXPECT_DOUBLE_EQ(position_sigma_m(map, map.landmarks[0]), depth_deviation_m(1.5));
}

TEST(Covisible, CountsWhatIsSharedMostFirst) {
  SparseMap map = map_of(5, 60);
  const auto both_see = [&](std::uint32_t keyframe, std::uint32_t begin, std::uint32_t end) {
    for (std::uint32_t l = begin; l < end; ++l) add_observation(map, l, {keyframe, l});
  };
  both_see(0, 0, 60);
  both_see(1, 0, 15);
  both_see(2, 0, 14);
  both_see(3, 20, 50);
  both_see(4, 45, 60);
  EXPECT_EQ(covisible(map, 0), (std::vector<Covisible>{{3, 30}, {1, 15}, {4, 15}}));
  EXPECT_EQ(covisible(map, 4, 5), (std::vector<Covisible>{{0, 15}, {3, 5}}));
  EXPECT_TRUE(covisible(map, 2).empty());
  EXPECT_EQ(landmarks_of(map, {2, 1}).size(), 15u);
  EXPECT_TRUE(landmarks_of(map, {}).empty());
}

TEST(MergeLandmarks, ObservationsMoveAndATombstoneStays) {
  SparseMap map = map_of(4, 3);
  add_observation(map, 0, {0, 0});
  add_observation(map, 0, {2, 0});
  add_observation(map, 1, {1, 1});
  add_observation(map, 1, {2, 1});
  map.landmarks[0].position_in_submap_m = {1, 2, 3};
  merge_landmarks(map, 1, 0);
  EXPECT_EQ(map.landmarks[0].observations, (std::vector<Observation>{{0, 0}, {1, 1}, {2, 0}}));
  EXPECT_TRUE(map.landmarks[1].observations.empty());
  EXPECT_EQ(map.keyframes[2].landmark_of_feature[1], kNoLandmark);
  EXPECT_EQ(map.landmarks[0].position_in_submap_m, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(map.landmarks.size(), 3u);
  expect_consistent(map);
  merge_landmarks(map, 1, 0);  // a tombstone has nothing to move
  EXPECT_EQ(map.landmarks[0].observations.size(), 3u);
}

TEST(RemoveObservation, TheOthersStayAndTheDescriptorIsTheirs) {
  SparseMap map = map_of(2, 2);
  add_observation(map, 1, {0, 1});
  add_observation(map, 1, {1, 0});
  remove_observation(map, 1, {0, 1});
  EXPECT_EQ(map.landmarks[1].observations, (std::vector<Observation>{{1, 0}}));
  EXPECT_EQ(map.landmarks[1].descriptor, map.keyframes[1].features[0].descriptor);
  expect_consistent(map);
  remove_observation(map, 1, {1, 0});
  EXPECT_TRUE(map.landmarks[1].observations.empty());
  expect_consistent(map);
}

TEST(BuryLandmark, NobodySeesItAnyMore) {
  SparseMap map = map_of(2, 2);
  add_observation(map, 1, {0, 1});
  add_observation(map, 1, {1, 0});
  bury_landmark(map, 1);
  EXPECT_TRUE(map.landmarks[1].observations.empty());
  EXPECT_TRUE(landmarks_of(map, {0, 1}).empty());
  expect_consistent(map);
}

}  // namespace
}  // namespace hermite::adjust
