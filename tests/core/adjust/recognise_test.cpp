#include "core/adjust/recognise.h"

#include <gtest/gtest.h>

#include "core/adjust/features.h"
#include "core/adjust/landmarks.h"
#include "core/synthetic/synthetic_camera.h"
#include "tests/core/adjust/point_world.h"

namespace hermite::adjust {
namespace {

struct Place {
  SparseMap map = test::empty_map();
  PlaceIndex index;

  void add(Keyframe keyframe) {
    const InsertResult result = insert_keyframe(map, std::move(keyframe));
    for (const std::uint32_t landmark : result.repeated)
      index.add(landmark, map.landmarks[landmark].descriptor);
  }
  // All around in a world of points, as seen in the submap.
  void add_round(const test::PointWorld& world, std::uint32_t submap = 0) {
    for (int i = 0; i < 36; ++i) {
      const Rigid3 pose = test::looking(10 * i);
      add(test::keyframe_of(world.view(pose, test::kViewNoise, static_cast<std::uint64_t>(i + 1)),
                            pose, submap));
    }
  }
};

void expect_pose(const Rigid3& submap_from_camera, const Rigid3& truth) {
  const Rigid3 error = inverse(truth) * submap_from_camera;
  // A hundred points at 3 m, 2.5 cm each in depth and half a pixel sideways.
  EXPECT_LT(error.translation.norm(), 0.02);
  EXPECT_LT(angle_rad(error.rotation), 0.005);
}

TEST(Recognise, FindsThePoseWithoutAGuess) {
  const test::PointWorld world(3000);
  Place place;
  place.add_round(world);
  for (const double yaw_deg : {3.0, 77.0, 201.0}) {
    const Rigid3 truth = test::looking(yaw_deg, 0.2);
    const test::View view = world.view(truth, test::kViewNoise, 999);
    const std::vector<PlaceMatch> found = recognise(place.map, place.index, view.features);
    ASSERT_EQ(found.size(), 1u) << yaw_deg;
    expect_pose(found[0].submap_from_camera, truth);
    EXPECT_GT(found[0].matches.size(), 100u);
    EXPECT_LE(std::abs(static_cast<int>(found[0].keyframe) * 10 - static_cast<int>(yaw_deg)), 20);
    for (const LandmarkMatch& match : found[0].matches)
      EXPECT_GT(view.features[match.feature].depth_m, 0);
  }
}

TEST(Recognise, AnotherRoomIsNoPlace) {
  Place place;
  place.add_round(test::PointWorld(3000, 1));
  const test::PointWorld elsewhere(3000, 2);
  for (int yaw_deg = 0; yaw_deg < 360; yaw_deg += 60)
    EXPECT_TRUE(recognise(place.map, place.index,
                          elsewhere.view(test::looking(yaw_deg), test::kViewNoise, 999).features)
                    .empty());
}

TEST(Recognise, OfTwoRoomsAlikeBothAreListed) {
  const test::PointWorld world(3000);
  Place place;
  place.map.world_from_submap.push_back({Eigen::Quaterniond::Identity(), {20, 0, 0}});
  place.add_round(world, 0);
  place.add_round(world, 1);
  const Rigid3 truth = test::looking(45, 0.1);
  const std::vector<PlaceMatch> found =
      recognise(place.map, place.index, world.view(truth, test::kViewNoise, 999).features);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_NE(found[0].submap, found[1].submap);
  EXPECT_GE(found[0].matches.size(), found[1].matches.size());
  EXPECT_GT(found[1].matches.size(), found[0].matches.size() * 7 / 10);
  for (const PlaceMatch& match : found) expect_pose(match.submap_from_camera, truth);
}

TEST(Recognise, ThePoseIsInTheSubmapWhateverTheWorld) {
  const test::PointWorld world(3000);
  Place place;
  place.add_round(world);
  // A correction.
  place.map.world_from_submap[0] = exp_se3((Vector6d() << 4, -3, 2, 0.5, 1, -2).finished());
  const Rigid3 truth = test::looking(130, 0.2);
  const auto found =
      recognise(place.map, place.index, world.view(truth, test::kViewNoise, 999).features);
  ASSERT_EQ(found.size(), 1u);
  expect_pose(found[0].submap_from_camera, truth);
}

TEST(Recognise, ExcludedKeyframesAreNotFound) {
  const test::PointWorld world(3000);
  Place place;
  place.add_round(world);
  std::vector<std::uint32_t> all;
  for (std::uint32_t i = 0; i < place.map.keyframes.size(); ++i) all.push_back(i);
  EXPECT_TRUE(recognise(place.map, place.index,
                        world.view(test::looking(45), test::kViewNoise, 999).features, all)
                  .empty());
}

TEST(Recognise, TheSameQuestionGetsTheSameAnswer) {
  const test::PointWorld world(3000);
  Place place;
  place.add_round(world);
  const test::View view = world.view(test::looking(45), test::kViewNoise, 999);
  const auto first = recognise(place.map, place.index, view.features),
             second = recognise(place.map, place.index, view.features);
  ASSERT_EQ(first.size(), second.size());
  ASSERT_FALSE(first.empty());
  EXPECT_EQ(first[0].submap_from_camera.matrix(), second[0].submap_from_camera.matrix());
  EXPECT_EQ(first[0].matches, second[0].matches);
}

TEST(Recognise, FeaturesWithoutDepthOrAtAllFindNothing) {
  const test::PointWorld world(3000);
  Place place;
  place.add_round(world);
  test::View view = world.view(test::looking(45), test::kViewNoise, 999);
  for (Feature& feature : view.features) feature.depth_m = 0;
  EXPECT_TRUE(recognise(place.map, place.index, view.features).empty());
  EXPECT_TRUE(recognise(place.map, place.index, {}).empty());
  EXPECT_TRUE(recognise(test::empty_map(), PlaceIndex(), world.view(Rigid3()).features).empty());
}

// From images: a place of a rendered room, from a pose that the map does not have.
TEST(Recognise, FindsAPlaceOfARenderedRoom) {
  const Camera camera{320, 240, 262.5, 262.5, 159.5, 119.5, 5000, {}};
  const synthetic::SyntheticRoom room(synthetic::RoomScene::kRoom);
  const auto features = [&](const Rigid3& pose) {
    synthetic::RoomView view = room.render(camera, pose);
    return detect_features({0, std::move(view.depth), std::move(view.color)}, camera);
  };
  Place place;
  place.map.camera = camera;
  for (int i = 0; i < 6; ++i) {
    Keyframe keyframe;
    keyframe.submap_from_camera = synthetic::synthetic_pose(0.3 * i, 1);
    keyframe.features = features(keyframe.submap_from_camera);
    place.add(std::move(keyframe));
  }
  Rigid3 truth = synthetic::synthetic_pose(0.5, 1);
  truth.translation += Eigen::Vector3d(0.05, -0.08, 0.06);
  const auto found = recognise(place.map, place.index, features(truth));
  ASSERT_FALSE(found.empty());
  const Rigid3 error = inverse(truth) * found[0].submap_from_camera;
  // 320 pixels, 500 features: half a pixel is 6 mm at 3 m.
  EXPECT_LT(error.translation.norm(), 0.03);
  EXPECT_LT(angle_rad(error.rotation), 0.015);
}

}  // namespace
}  // namespace hermite::adjust
