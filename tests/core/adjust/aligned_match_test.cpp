#include "core/adjust/aligned_match.h"

#include <gtest/gtest.h>

#include "core/adjust/landmarks.h"
#include "tests/core/adjust/point_world.h"

namespace hermite::adjust::aligned_match_test {
namespace {

struct Scene {
  test::PointWorld world{8000};  // dense: a wrong neighbour is near
  test::View first = world.view(Rigid3(), {0.5, 1, 20});
  SparseMap map = test::empty_map();
  std::vector<std::uint32_t> landmarks;

  Scene() { landmarks = insert_keyframe(map, test::keyframe_of(first, Rigid3())).created; }
  std::size_t point(std::uint32_t landmark) const {
    return first.point_of_feature[map.landmarks[landmark].observations[0].feature];
  }
};

TEST(MatchAligned, FindsThePoseThatTheMatchesHaveInCommon) {
  const Scene scene;
  const Rigid3 truth = test::looking(5, 0.1);
  const test::View view = scene.world.view(truth, {0.5, 1, 30}, 5);
  // 0.4 degrees are 4 px.
  const Rigid3 guess =
      truth * exp_se3((Vector6d() << 0.003, 0.002, -0.004, 0.007, -0.007, 0).finished());
  const AlignedMatches aligned = match_aligned(scene.map, scene.landmarks, view.features, guess);
  const Rigid3 error = inverse(truth) * aligned.world_from_camera;
  // Of a thousand points of half a pixel and up to 4 cm in depth.
  EXPECT_LT(error.translation.norm(), 0.003);
  EXPECT_LT(angle_rad(error.rotation), 0.001);
  EXPECT_GT(aligned.matches.size(), view.features.size() * 7 / 10);
  std::size_t wrong = 0;
  for (const LandmarkMatch& match : aligned.matches)
    wrong += view.point_of_feature[match.feature] != scene.point(match.landmark);
  EXPECT_EQ(wrong, 0u);
}

TEST(MatchAligned, WithTooFewToAgreeTheGuessStays) {
  const Scene scene;
  test::View view = scene.world.view(Rigid3());
  view.features.resize(kLeastAlignedInliers - 1);
  const Rigid3 guess = exp_se3((Vector6d() << 0.001, 0, 0, 0, 0, 0).finished());
  const AlignedMatches aligned = match_aligned(scene.map, scene.landmarks, view.features, guess);
  EXPECT_EQ(aligned.world_from_camera.matrix(), guess.matrix());
  EXPECT_EQ(aligned.matches.size(), kLeastAlignedInliers - 1);
}

TEST(PointPairs, AreOfMatchesWithDepth) {
  Scene scene;
  std::vector<Feature> features = scene.first.features;
  features[0].depth_m = 0;
  std::vector<LandmarkMatch> matches{{0, 0, 0}, {1, 1, 0}};
  const std::vector<PointPair> pairs = point_pairs(scene.map, features, matches);
  ASSERT_EQ(pairs.size(), 1u);
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].feature, 1u);
  EXPECT_LT((pairs[0].point_in_camera_m - pairs[0].point_in_world_m).norm(), 1e-9);
  EXPECT_DOUBLE_EQ(pairs[0].pixel_sigma_px, octave_scale(features[1].octave));
  EXPECT_DOUBLE_EQ(pairs[0].world_sigma_m, depth_deviation_m(features[1].depth_m));
}

}  // namespace
}  // namespace hermite::adjust::aligned_match_test
