#include "core/adjust/submap_atlas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/adjust/submap_atlas_fields.h"

namespace hermite::adjust::submap_atlas_test {
namespace {

const Camera kCamera{320, 240, 262, 262, 159.5, 119.5, 5000};

Rigid3 at(double x_m, double turn_deg = 0) {
  Vector6d motion = Vector6d::Zero();
  motion[4] = turn_deg * M_PI / 180;
  Rigid3 pose = exp_se3(motion);
  pose.translation.x() = x_m;
  return pose;
}

void put_keyframe(SubmapAtlas& atlas, const Rigid3& world_from_camera) {
  const std::uint32_t submap = atlas.layout.current;
  atlas.map.keyframes.push_back({++atlas.frame,
                                 submap,
                                 inverse(atlas.map.world_from_submap[submap]) * world_from_camera,
                                 {},
                                 {},
                                 {}});
}

// The camera goes along x to `end_m` in steps of a centimetre, with a keyframe at every decimetre.
SubmapAtlas walked(double end_m, const AdjustOptions& options = {}) {
  SubmapAtlas atlas = make_submap_atlas(kCamera);
  for (int i = 0; 0.01 * i <= end_m; ++i) {
    atlas.submap_from_camera =
        inverse(atlas.map.world_from_submap[atlas.layout.current]) * at(0.01 * i);
    choose_submap(atlas, options);
    if (i % 10 == 0) put_keyframe(atlas, at(0.01 * i));
  }
  return atlas;
}

TEST(SubmapAtlas, BeginsWithOneSubmapInTheWorldFrame) {
  const SubmapAtlas atlas = make_submap_atlas(kCamera);
  EXPECT_EQ(atlas.map.world_from_submap.size(), 1u);
  EXPECT_EQ(atlas.graph.component.size(), 1u);
  EXPECT_EQ(atlas.layout.world_from_submap.size(), 1u);
  EXPECT_EQ(world_from_camera(atlas).matrix(), Rigid3{}.matrix());
}

TEST(SubmapAtlas, ACameraThatGoesOnOpensSubmapsLinkedToThoseBefore) {
  const SubmapAtlas atlas = walked(1.0);
  ASSERT_EQ(atlas.layout.world_from_submap.size(), 4u) << "one per 0.3 m";
  EXPECT_EQ(atlas.layout.current, 3u);
  EXPECT_EQ(atlas.graph.parent, (std::vector<std::uint32_t>{0, 0, 1, 2}));
  EXPECT_NEAR(atlas.layout.world_from_submap[3].translation.x(), 0.9, 0.011);
  EXPECT_NEAR(distances_m(atlas.graph, 0)[3], 0.9, 0.011);
  EXPECT_NEAR(world_from_camera(atlas).translation.x(), 1.0, 1e-12);
}

TEST(SubmapAtlas, ACameraThatComesBackGoesOnInTheOldSubmap) {
  SubmapAtlas atlas = walked(0.35);
  ASSERT_EQ(atlas.layout.current, 1u);
  atlas.submap_from_camera = inverse(atlas.map.world_from_submap[1]) * at(-0.05);
  EXPECT_FALSE(choose_submap(atlas, {}));
  EXPECT_EQ(atlas.layout.current, 0u);
  EXPECT_NEAR(world_from_camera(atlas).translation.x(), -0.05, 1e-12);
}

TEST(SubmapAtlas, SubmapsFarAlongThePathAreInactiveUnlessLoopsAreNeverClosed) {
  AdjustOptions options;
  options.active_path_m = 0.5;
  EXPECT_EQ(walked(1.0, options).layout.is_active, (std::vector<bool>{false, false, true, true}));
  options.global_bundle_adjustment = false;
  EXPECT_EQ(walked(1.0, options).layout.is_active, std::vector<bool>(4, true));
}

TEST(SubmapAtlas, AnotherComponentIsInactiveWhereverItLies) {
  SubmapAtlas atlas = walked(0.2);
  enter_submap(atlas, open_submap(atlas, at(0.2), atlas.component_count++), at(0.2), {});
  EXPECT_EQ(atlas.layout.component, (std::vector<std::uint32_t>{0, 1}));
  EXPECT_EQ(atlas.layout.is_active, (std::vector<bool>{false, true}));
  EXPECT_EQ(submaps_of(atlas.graph, 0), std::vector<std::uint32_t>{0});
  EXPECT_TRUE(keyframes_in_view(atlas, true).empty());
  EXPECT_TRUE(keyframes_in_view(atlas, false).empty()) << "only of the camera's component";
  const LoopCandidate back = candidate_at(atlas, at(0.1), 0, true);
  EXPECT_EQ(back.submaps, (std::vector<bool>{true, false}));
  EXPECT_TRUE(is_of_another_component(atlas, back));
}

TEST(SubmapAtlas, KeyframesNearTheCameraAreListedNearestFirst) {
  const SubmapAtlas atlas = walked(0.5);
  EXPECT_EQ(keyframes_near(atlas, 0.25, 0.1, true), (std::vector<std::uint32_t>{5, 4, 3}));
  EXPECT_TRUE(keyframes_near(atlas, 0.25, 0.1, false).empty());
  EXPECT_FALSE(is_new_view(atlas, {}));
}

TEST(SubmapAtlas, TurnedAwayIsANewViewAndHasNothingInView) {
  SubmapAtlas atlas = walked(0.2);
  atlas.submap_from_camera = at(0.2, 100);
  EXPECT_TRUE(is_new_view(atlas, {}));
  EXPECT_TRUE(keyframes_in_view(atlas, true).empty());
  EXPECT_EQ(submaps_in_view(atlas, world_from_camera(atlas), 0), std::vector<bool>{false});
  EXPECT_EQ(submaps_in_view(atlas, at(0.2, 80), 0), std::vector<bool>{true});
}

TEST(SubmapAtlas, NearestIsAmongThoseAskedFor) {
  const SubmapAtlas atlas = walked(1.0);
  EXPECT_EQ(nearest_submap(atlas, {true, true, true, true}, at(0.35)), 1u);
  EXPECT_EQ(nearest_submap(atlas, {true, false, true, true}, at(0.5)), 2u);
  EXPECT_EQ(nearest_submap(atlas, std::vector<bool>(4, false), at(0.5)), atlas.layout.current);
}

TEST(SubmapAtlas, TheFrontEndSeesWhatIsPublished) {
  SubmapAtlas atlas = walked(0.5);
  atlas.map.world_from_submap[1] = at(0.4);
  EXPECT_NE(atlas.layout.world_from_submap[1].translation.x(), 0.4);
  publish_correction(atlas);
  EXPECT_EQ(atlas.layout.world_from_submap[1].translation.x(), 0.4);
  EXPECT_EQ(atlas.layout.correction_count, 1u);
}

std::string saved(const SubmapAtlas& atlas) {
  ByteWriter bytes;
  save(bytes, atlas);
  return bytes.take();
}

bool is_restored(const std::string& state) {
  SubmapAtlas atlas = make_submap_atlas(kCamera);
  ByteReader bytes(state);
  restore(bytes, atlas);
  return bytes.ok() && bytes.at_end();
}

TEST(SubmapAtlas, IsRestoredAsItWas) {
  SubmapAtlas atlas = walked(1.0);
  atlas.map.keyframes[0].features.resize(2);
  atlas.map.keyframes[0].landmark_of_feature = {kNoLandmark, 0};
  atlas.map.landmarks.push_back({0, {1, 2, 3}, {}, {{0, 1}}});
  atlas.losses.push_back({0, 1, {1, 2, 3}, 0.5});
  publish(atlas);
  const std::string state = saved(atlas);
  SubmapAtlas restored = make_submap_atlas(kCamera);
  ByteReader bytes(state);
  restore(bytes, restored);
  ASSERT_TRUE(bytes.ok() && bytes.at_end());
  EXPECT_EQ(saved(restored), state);
  EXPECT_EQ(restored.map.keyframes[0].landmark_of_feature,
            atlas.map.keyframes[0].landmark_of_feature);
  EXPECT_EQ(restored.layout.component, atlas.layout.component);
  ASSERT_EQ(restored.losses.size(), 1u);
  EXPECT_EQ(restored.losses[0].reach_m, 0.5);
  EXPECT_EQ(restored.layout.world_from_submap[3].matrix(),
            atlas.layout.world_from_submap[3].matrix());
}

TEST(SubmapAtlas, AStateThatContradictsItselfIsRefused) {
  const SubmapAtlas right = walked(0.5);
  EXPECT_TRUE(is_restored(saved(right)));
  SubmapAtlas nowhere = right, orphan = right, stranger = right, timeless = right,
              unreachable = right;
  nowhere.layout.current = 2;
  orphan.graph.parent[1] = 2;
  stranger.map.keyframes[0].submap = 2;
  timeless.frame = std::int64_t{1} << 41;
  unreachable.losses.push_back({0, 2, Eigen::Vector3d::Zero(), 1});
  EXPECT_FALSE(is_restored(saved(unreachable)));
  EXPECT_FALSE(is_restored(saved(nowhere)));
  EXPECT_FALSE(is_restored(saved(orphan)));
  EXPECT_FALSE(is_restored(saved(stranger)));
  EXPECT_FALSE(is_restored(saved(timeless)));
}

}  // namespace
}  // namespace hermite::adjust::submap_atlas_test
