#include "core/adjust/loop_closing.h"

#include <gtest/gtest.h>

namespace hermite::adjust::loop_closing_test {
namespace {

const Camera kCamera{320, 240, 262, 262, 159.5, 119.5, 5000};

Rigid3 at(double x_m, double z_m = 0) {
  Rigid3 pose;
  pose.translation = {x_m, 0, z_m};
  return pose;
}

// Four submaps in a row, each linked to the one before.
SubmapAtlas row() {
  SubmapAtlas atlas = make_submap_atlas(kCamera);
  for (std::uint32_t i = 1; i < 4; ++i) {
    open_submap(atlas, at(i), 0);
    atlas.graph.links.push_back({i - 1, i, at(1), 1, false});
  }
  return atlas;
}

SubmapLink loop(std::uint32_t from, std::uint32_t to, const Rigid3& from_from_to) {
  return {from, to, from_from_to, 0, true};
}

TEST(LoopClosing, ADriftIsSpreadOverTheLinks) {
  SubmapAtlas atlas = row();
  const std::optional<ClosedLoop> closed = close_loop(atlas, loop(3, 0, at(-3, 0.03)));
  ASSERT_TRUE(closed);
  EXPECT_TRUE(closed->has_moved);
  EXPECT_FALSE(closed->joins_components);
  const std::vector<Rigid3>& poses = atlas.layout.world_from_submap;
  EXPECT_EQ(poses[0].matrix(), Rigid3{}.matrix());
  EXPECT_NEAR(poses[3].translation.z(), -0.03, 0.01);
  EXPECT_LT(poses[1].translation.z(), 0);
  EXPECT_LT(poses[2].translation.z(), poses[1].translation.z());
  EXPECT_EQ(atlas.layout.closure_count, 1u);
  EXPECT_EQ(atlas.layout.correction_count, 1u);
  EXPECT_TRUE(atlas.graph.links.back().is_loop);
}

TEST(LoopClosing, ALoopThatSaysNothingNewMovesNothing) {
  SubmapAtlas atlas = row();
  const std::optional<ClosedLoop> closed = close_loop(atlas, loop(3, 0, at(-3, 0.0005)));
  ASSERT_TRUE(closed);
  EXPECT_FALSE(closed->has_moved);
  EXPECT_EQ(atlas.layout.world_from_submap[3].matrix(), at(3).matrix());
  EXPECT_EQ(atlas.layout.closure_count, 1u);
  EXPECT_EQ(atlas.layout.correction_count, 0u);
  EXPECT_EQ(atlas.graph.links.size(), 4u);
}

TEST(LoopClosing, AContradictionChangesNothing) {
  SubmapAtlas atlas = row();
  ASSERT_TRUE(close_loop(atlas, loop(3, 0, at(-3))));
  EXPECT_FALSE(close_loop(atlas, loop(3, 0, at(-3, 2))));
  EXPECT_EQ(atlas.graph.links.size(), 4u);
  EXPECT_EQ(atlas.layout.closure_count, 1u);
  for (std::uint32_t i = 0; i < 4; ++i)
    EXPECT_EQ(atlas.map.world_from_submap[i].matrix(), at(i).matrix());
}

TEST(LoopClosing, OfTwoComponentsTheOlderOneStays) {
  for (const bool from_the_older : {false, true}) {
    SubmapAtlas atlas = row();
    const std::uint32_t other = open_submap(atlas, at(100), atlas.component_count++);
    const std::optional<ClosedLoop> closed =
        close_loop(atlas, from_the_older ? loop(2, other, at(0.5)) : loop(other, 2, at(-0.5)));
    ASSERT_TRUE(closed);
    EXPECT_TRUE(closed->has_moved);
    EXPECT_TRUE(closed->joins_components);
    EXPECT_EQ(atlas.layout.component, std::vector<std::uint32_t>(5, 0));
    EXPECT_NEAR(atlas.layout.world_from_submap[other].translation.x(), 2.5, 1e-6);
    EXPECT_NEAR(atlas.layout.world_from_submap[3].translation.x(), 3, 1e-6);
  }
}

TEST(LoopClosing, AComponentIsNotJoinedWhereTheCameraCannotHaveCome) {
  SubmapAtlas atlas = row();
  atlas.layout.current = 3;
  // Lost 0.2 m from the origin of the last submap.
  const std::uint32_t other = open_component(atlas, at(3.2), 1);
  EXPECT_FALSE(close_loop(atlas, loop(other, 1, at(-0.2)))) << "2 m back";
  EXPECT_EQ(atlas.graph.component.back(), 1u);
  EXPECT_EQ(atlas.map.world_from_submap[other].matrix(), at(3.2).matrix());
  EXPECT_EQ(atlas.graph.links.size(), 3u);
  EXPECT_EQ(atlas.layout.closure_count, 0u);
  EXPECT_TRUE(close_loop(atlas, loop(other, 2, at(-0.5)))) << "0.7 m back";
  EXPECT_EQ(atlas.layout.component, std::vector<std::uint32_t>(5, 0));
}

}  // namespace
}  // namespace hermite::adjust::loop_closing_test
