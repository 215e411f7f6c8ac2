#include "core/adjust/projection_match.h"

#include <gtest/gtest.h>

#include <limits>

#include "tests/core/adjust/point_world.h"

namespace hermite::adjust::projection_match_test {
namespace {

// A map of one keyframe at the origin whose features are landmarks 0, 1, 2... with true positions.
struct Scene {
  test::PointWorld world{2000};
  test::View seen = world.view(Rigid3());
  SparseMap map = test::empty_map();
  std::vector<std::uint32_t> landmarks;

  Scene() {
    Keyframe keyframe = test::keyframe_of(seen, Rigid3());
    keyframe.landmark_of_feature.assign(keyframe.features.size(), kNoLandmark);
    map.keyframes.push_back(keyframe);
    for (std::uint32_t i = 0; i < seen.features.size(); ++i) {
      map.landmarks.push_back({0, world.points[seen.point_of_feature[i]].position_m, {}, {}});
      add_observation(map, i, {0, i});
      landmarks.push_back(i);
    }
  }
  bool right(const LandmarkMatch& match, const test::View& view) const {
    return view.point_of_feature[match.feature] == seen.point_of_feature[match.landmark];
  }
  std::vector<LandmarkMatch> match(const std::vector<Feature>& features, const Rigid3& pose,
                                   const ProjectionOptions& options = {}) const {
    return match_projected(map, landmarks, features, pose, options);
  }
};

TEST(MatchProjected, FindsEveryFeatureFromTheSamePose) {
  const Scene scene;
  const auto matches = scene.match(scene.seen.features, Rigid3());
  ASSERT_EQ(matches.size(), scene.seen.features.size());
  for (const LandmarkMatch& match : matches) {
    EXPECT_EQ(match.feature, match.landmark);
    EXPECT_EQ(match.distance, 0);
  }
}

TEST(MatchProjected, FromAnotherPoseWithNoiseTheyAreRight) {
  const Scene scene;
  const Rigid3 pose = test::looking(15, 0.4);
  const test::View view = scene.world.view(pose, {0.5, 1, 40});
  const auto matches = scene.match(view.features, pose);
  EXPECT_GT(matches.size(), 100u);
  for (const LandmarkMatch& match : matches) EXPECT_TRUE(scene.right(match, view));
}

TEST(MatchProjected, FollowsACameraThatIsRolled) {
  const Scene scene;
  Rigid3 pose;
  pose.rotation = Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ()));
  const test::View view = scene.world.view(pose);
  const auto matches = scene.match(view.features, pose);
  EXPECT_GT(matches.size(), 100u);
  for (const LandmarkMatch& match : matches) EXPECT_TRUE(scene.right(match, view));
}

// One feature of the view is changed, and must then not be matched; all others still are.
class MatchProjectedRefuses : public ::testing::Test {
 protected:
  void expect_refused(const std::vector<Feature>& features) {
    const auto matches = scene_.match(features, Rigid3());
    EXPECT_EQ(matches.size(), scene_.seen.features.size() - 1);
    for (const LandmarkMatch& match : matches) EXPECT_NE(match.feature, kChanged);
  }
  static constexpr std::uint32_t kChanged = 7;
  const Scene scene_;
  std::vector<Feature> features_ = scene_.seen.features;
};

TEST_F(MatchProjectedRefuses, AnotherTurn) {
  features_[kChanged].angle_rad += 0.7f;
  expect_refused(features_);
}

TEST_F(MatchProjectedRefuses, AnotherOctave) {
  features_[kChanged].octave = static_cast<std::uint8_t>(features_[kChanged].octave < 4 ? 7 : 0);
  expect_refused(features_);
}

TEST_F(MatchProjectedRefuses, AnotherDepth) {
  features_[kChanged].depth_m += 0.2f;
  expect_refused(features_);
}

TEST_F(MatchProjectedRefuses, AnotherDescriptor) {
  std::mt19937_64 random(9);
  features_[kChanged].descriptor = test::random_descriptor(random);
  expect_refused(features_);
}

TEST_F(MatchProjectedRefuses, APlaceTooFarAway) {
  features_[kChanged].pixel_px.x() +=
      8 * static_cast<float>(octave_scale(features_[kChanged].octave));
  expect_refused(features_);
}

TEST_F(MatchProjectedRefuses, OneOfTwoThatLookAlike) {
  Feature twin = features_[kChanged];
  twin.pixel_px.x() += 2;
  features_.push_back(twin);
  for (const LandmarkMatch& match : scene_.match(features_, Rigid3())) {
    EXPECT_NE(match.feature, kChanged);
    EXPECT_NE(match.feature, features_.size() - 1);
  }
}

TEST_F(MatchProjectedRefuses, ButAFeatureWithoutDepthCanMatch) {
  features_[kChanged].depth_m = 0;
  EXPECT_EQ(scene_.match(features_, Rigid3()).size(), features_.size());
}

TEST(MatchProjected, TombstonesAndPosesThatAreNone) {
  Scene scene;
  bury_landmark(scene.map, 3);
  EXPECT_EQ(scene.match(scene.seen.features, Rigid3()).size(), scene.seen.features.size() - 1);
  Rigid3 nonsense;
  nonsense.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(scene.match(scene.seen.features, nonsense).empty());
  EXPECT_TRUE(scene.match({}, Rigid3()).empty());
  EXPECT_TRUE(scene.match(scene.seen.features, test::looking(180)).empty());
}

TEST(MatchProjected, FeaturesOfNonsenseMatchNothing) {
  const Scene scene;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<Feature> features = scene.seen.features;
  features[1].pixel_px.x() = nan;
  features[2].pixel_px.y() = std::numeric_limits<float>::infinity();
  features[3].angle_rad = nan;
  features[4].depth_m = nan;
  for (const LandmarkMatch& match : scene.match(features, Rigid3()))
    EXPECT_TRUE(match.feature == 0 || match.feature > 4);
}

TEST(MatchProjected, FollowsACorrectionOfTheSubmap) {
  Scene scene;
  const Rigid3 correction = exp_se3((Vector6d() << 0.3, 0.2, -0.1, 0.1, 0.2, 0.3).finished());
  scene.map.world_from_submap[0] = correction;
  EXPECT_EQ(scene.match(scene.seen.features, correction).size(), scene.seen.features.size());
}

TEST(OneToOne, TheNearestDescriptorsComeFirst) {
  const std::vector<LandmarkMatch> kept =
      one_to_one({{0, 5, 40}, {0, 6, 20}, {1, 6, 10}, {2, 5, 30}});
  EXPECT_EQ(kept, (std::vector<LandmarkMatch>{{1, 6, 10}, {2, 5, 30}}));
  EXPECT_TRUE(one_to_one({}).empty());
}

}  // namespace
}  // namespace hermite::adjust::projection_match_test
