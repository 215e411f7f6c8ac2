#include "core/adjust/repetition.h"

#include <gtest/gtest.h>

#include "core/adjust/landmarks.h"
#include "tests/core/adjust/point_world.h"

namespace hermite::adjust::repetition_test {
namespace {

struct Mapped {
  SparseMap map = test::empty_map();
  PlaceIndex index;

  // All around in a world of points, whose origin is at `world_from_room`.
  void add_round(const test::PointWorld& room, const Rigid3& world_from_room = {}) {
    for (int i = 0; i < 36; ++i) {
      const Rigid3 pose = test::looking(10 * i);
      const auto view = room.view(pose, test::kViewNoise, static_cast<std::uint64_t>(i + 1));
      const InsertResult result =
          insert_keyframe(map, test::keyframe_of(view, world_from_room * pose));
      for (const std::uint32_t landmark : result.repeated)
        index.add(landmark, map.landmarks[landmark].descriptor);
    }
  }

  Repetition seen_from(const test::PointWorld& room, const Rigid3& room_from_camera,
                       const Rigid3& world_from_camera, std::int64_t known) const {
    return repetition_of(map, index, room.view(room_from_camera, test::kViewNoise, 999).features,
                         world_from_camera, known);
  }
};

const Rigid3 kView = test::looking(45, 0.1);
// As somebody who sits across the table has it.
const Rigid3 kTwin{Eigen::Quaterniond(Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitY())),
                   {20, 0, 0}};

TEST(Repetition, APlaceThatIsThereOnceIsDistinctive) {
  const test::PointWorld room(3000);
  Mapped mapped;
  mapped.add_round(room);
  const Repetition found = mapped.seen_from(room, kView, kView, 36);
  EXPECT_GT(found.here, 100u);
  EXPECT_EQ(found.elsewhere, 0u);
  EXPECT_TRUE(is_distinctive(found));
}

TEST(Repetition, ItsTwinIsFoundTurnedAround) {
  const test::PointWorld room(3000);
  Mapped mapped;
  mapped.add_round(room);
  mapped.add_round(room, kTwin);
  for (const Rigid3& pose : {kView, kTwin * kView}) {
    const Repetition found = mapped.seen_from(room, kView, pose, 72);
    EXPECT_GT(found.here, 100u);
    EXPECT_GT(found.elsewhere, found.here / 4);
    EXPECT_FALSE(is_distinctive(found));
  }
}

TEST(Repetition, WhatWasSeenLaterDoesNotCount) {
  const test::PointWorld room(3000);
  Mapped mapped;
  mapped.add_round(room);
  mapped.add_round(room, kTwin);
  EXPECT_EQ(mapped.seen_from(room, kView, kView, 36).elsewhere, 0u);
  EXPECT_EQ(mapped.seen_from(room, kView, kTwin * kView, 36).here, 0u);
}

TEST(Repetition, WhatTheMapDoesNotHaveIsNotDistinctive) {
  Mapped mapped;
  mapped.add_round(test::PointWorld(3000, 1));
  const Repetition found = mapped.seen_from(test::PointWorld(3000, 2), kView, kView, 36);
  EXPECT_LT(found.here, 15u);
  EXPECT_FALSE(is_distinctive(found));
  EXPECT_FALSE(is_distinctive(repetition_of(test::empty_map(), PlaceIndex(), {}, kView, 0)));
}

TEST(Repetition, ACameraThatStandsStillKnowsItsOneView) {
  const test::PointWorld room(3000);
  Mapped mapped;
  insert_keyframe(mapped.map, test::keyframe_of(room.view(kView, test::kViewNoise, 1), kView));
  EXPECT_TRUE(is_distinctive(mapped.seen_from(room, kView, kView, 1)));
  EXPECT_FALSE(is_distinctive(mapped.seen_from(room, kView, kView, 0))) << "it was seen later";
}

TEST(Repetition, SomeOfARoomMayRecur) {
  EXPECT_TRUE(is_distinctive({100, 15}));
  EXPECT_FALSE(is_distinctive({100, 30}));
  EXPECT_FALSE(is_distinctive({10, 0}));
}

}  // namespace
}  // namespace hermite::adjust::repetition_test
