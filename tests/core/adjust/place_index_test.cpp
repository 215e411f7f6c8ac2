#include "core/adjust/place_index.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "core/adjust/landmarks.h"
#include "tests/core/adjust/point_world.h"

namespace hermite::adjust {
namespace {

// Keyframes all around, 10 degrees apart: 62 degrees are seen at once, so keyframes from the
// seventh on share nothing with the first.
struct Round {
  test::PointWorld world{3000};
  SparseMap map = test::empty_map();
  PlaceIndex index;

  Round() {
    for (int i = 0; i < 36; ++i) {
      const Rigid3 pose = test::looking(10 * i);
      const auto seed = static_cast<std::uint64_t>(i + 1);
      const InsertResult result =
          insert_keyframe(map, test::keyframe_of(world.view(pose, test::kViewNoise, seed), pose));
      for (const std::uint32_t landmark : result.repeated)
        index.add(landmark, map.landmarks[landmark].descriptor);
    }
  }
};

const Round& round_of_the_room() {
  static const Round round;
  return round;
}

TEST(PlaceIndex, TheBestCandidateLooksWhereTheImageDoes) {
  const Round& round = round_of_the_room();
  for (const int yaw_deg : {33, 147, 298}) {
    const test::View view = round.world.view(test::looking(yaw_deg, 0.1), test::kViewNoise, 1000);
    const auto candidates = round.index.query(view.features, round.map);
    ASSERT_FALSE(candidates.empty());
    EXPECT_LE(std::abs(static_cast<int>(candidates[0].keyframe) * 10 - yaw_deg), 15);
    EXPECT_GT(candidates[0].matches.size(), 50u);
    EXPECT_EQ(candidates[0].keyframes[0], candidates[0].keyframe);
    EXPECT_LE(candidates[0].keyframes.size(), 10u);
    EXPECT_TRUE(std::is_sorted(candidates.begin(), candidates.end(),
                               [](const auto& a, const auto& b) { return a.score > b.score; }));
  }
}

TEST(PlaceIndex, CandidatesAreDifferentPlaces) {
  const Round& round = round_of_the_room();
  std::vector<Feature> features =
      round.world.view(test::looking(90), test::kViewNoise, 1000).features;
  const std::vector<Feature> behind =
      round.world.view(test::looking(270), test::kViewNoise, 1001).features;
  features.insert(features.end(), behind.begin(), behind.end());
  const auto candidates = round.index.query(features, round.map);
  ASSERT_GE(candidates.size(), 2u);
  for (std::size_t i = 0; i < candidates.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      for (const Covisible& near : covisible(round.map, candidates[j].keyframe))
        EXPECT_NE(candidates[i].keyframe, near.keyframe);
}

TEST(PlaceIndex, ExcludedKeyframesAreInNoPlace) {
  const Round& round = round_of_the_room();
  const std::vector<std::uint32_t> excluded{8, 9, 10};
  for (const PlaceCandidate& candidate :
       round.index.query(round.world.view(test::looking(90), test::kViewNoise, 1000).features,
                         round.map, excluded))
    for (const std::uint32_t keyframe : candidate.keyframes)
      EXPECT_EQ(std::count(excluded.begin(), excluded.end(), keyframe), 0) << keyframe;
}

TEST(PlaceIndex, TombstonesDoNotVote) {
  SparseMap map = round_of_the_room().map;
  for (std::uint32_t landmark = 0; landmark < map.landmarks.size(); ++landmark)
    bury_landmark(map, landmark);
  const test::View view = round_of_the_room().world.view(test::looking(0), test::kViewNoise, 1000);
  EXPECT_TRUE(round_of_the_room().index.query(view.features, map).empty());
}

TEST(PlaceIndex, AnEmptyOneHasNoPlaces) {
  const PlaceIndex index;
  EXPECT_EQ(index.size(), 0u);
  EXPECT_TRUE(
      index.query(round_of_the_room().world.view(Rigid3()).features, round_of_the_room().map)
          .empty());
  EXPECT_TRUE(round_of_the_room().index.query({}, round_of_the_room().map).empty());
}

// Two keyframes: one sees ten copies of one descriptor, the other one landmark of its own. The
// query has both descriptors.
TEST(PlaceIndex, WhatIsEverywhereSaysLittle) {
  std::mt19937_64 random(1);
  const Descriptor common = test::random_descriptor(random), rare = test::random_descriptor(random);
  SparseMap map = test::empty_map();
  PlaceIndex index;
  map.landmarks.resize(30);
  for (std::uint32_t k = 0; k < 3; ++k) {
    Keyframe keyframe;
    keyframe.features.resize(10);
    keyframe.landmark_of_feature.assign(10, kNoLandmark);
    for (Feature& feature : keyframe.features) feature.descriptor = common;
    if (k == 2) keyframe.features.resize(1), keyframe.features[0].descriptor = rare;
    map.keyframes.push_back(keyframe);
    for (std::uint32_t i = 0; i < map.keyframes[k].features.size(); ++i) {
      add_observation(map, k * 10 + i, {k, i});
      index.add(k * 10 + i, map.landmarks[k * 10 + i].descriptor);
    }
  }
  std::vector<Feature> query(2);
  query[0].descriptor = common;
  query[1].descriptor = rare;
  const auto candidates = index.query(query, map);
  ASSERT_EQ(candidates.size(), 3u);
  EXPECT_EQ(candidates[0].keyframe, 2u);
}

TEST(PlaceIndex, MemoryIsWhatTheHeaderSays) {
  PlaceIndex index;
  std::mt19937_64 random(1);
  const std::size_t empty_bytes = index.memory_bytes();
  EXPECT_EQ(empty_bytes, 16u * 65536 * 5);
  for (std::uint32_t i = 0; i < 4096; ++i) index.add(i, test::random_descriptor(random));
  EXPECT_EQ(index.size(), 4096u);
  // A vector may have room for twice as many.
  EXPECT_LE(index.memory_bytes() - empty_bytes, 2u * 4096 * 104);
}

// A million equal descriptors would make every query look at a million.
TEST(PlaceIndex, EqualDescriptorsAreBounded) {
  std::mt19937_64 random(1);
  Keyframe keyframe;
  Feature feature;
  feature.descriptor = test::random_descriptor(random);
  keyframe.features.assign(1000, feature);
  keyframe.landmark_of_feature.assign(1000, kNoLandmark);
  SparseMap map = test::empty_map();
  map.keyframes.push_back(keyframe);
  map.landmarks.resize(1000);
  PlaceIndex index;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    add_observation(map, i, {0, i});
    index.add(i, feature.descriptor);
  }
  EXPECT_TRUE(index.query({feature}, map).empty());  // it has more landmarks than a vote may have
}

}  // namespace
}  // namespace hermite::adjust
