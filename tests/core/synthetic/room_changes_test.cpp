#include "core/synthetic/room_changes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "core/synthetic/synthetic_camera.h"

namespace hermite::synthetic::room_changes_test {

using ::testing::HasSubstr;

std::string error_of(const std::string& options) {
  const Result<SyntheticOptions> parsed = parse_synthetic_options(options);
  return parsed.ok() ? "" : parsed.error().message;
}

TEST(RoomChanges, AnObjectMovesAndAnotherOneGoes) {
  const Furniture before = furnish(RoomScene::kRoom);
  Furniture after = before;
  std::vector<RoomChange> changes = *parse_moved_objects("sofa:-20:0:5");
  for (const RoomChange& change : parse_removed_objects("vase/desk")) changes.push_back(change);
  ASSERT_TRUE(apply_changes(changes, after).ok());
  const auto object = [](const Furniture& furniture, const std::string& name) {
    return *std::find_if(furniture.objects.begin(), furniture.objects.end(),
                         [&](const NamedObject& o) { return o.name == name; });
  };
  const NamedObject vase = object(before, "vase"), desk = object(before, "desk"),
                    sofa = object(before, "sofa"), moved = object(after, "sofa");
  EXPECT_EQ(after.shapes.size(),
            before.shapes.size() - (vase.last - vase.first) - (desk.last - desk.first));
  ASSERT_EQ(moved.last - moved.first, sofa.last - sofa.first);
  for (std::size_t i = 0; i < moved.last - moved.first; ++i)
    EXPECT_LT((after.shapes[moved.first + i].center - before.shapes[sofa.first + i].center -
               Eigen::Vector3d(-0.020, 0, 0.005))
                  .norm(),
              1e-12);
  for (const NamedObject& left : after.objects) {
    EXPECT_LE(left.last, after.shapes.size());
    EXPECT_NE(left.name, "screen") << "it stood on the desk";
  }
}

TEST(RoomChanges, NamesAreUniqueInEveryScene) {
  for (const RoomScene scene : {RoomScene::kRoom, RoomScene::kLoop, RoomScene::kTwins,
                                RoomScene::kOffice, RoomScene::kBlank}) {
    std::set<std::string> names;
    for (const NamedObject& object : furnish(scene).objects)
      EXPECT_TRUE(names.insert(object.name).second) << object.name;
  }
}

TEST(RoomChanges, WrongOptionsAreNamed) {
  EXPECT_EQ(error_of("moved=chair2:10:0:0/ball:0:-5:0,removed=plant,start=12"), "");
  EXPECT_THAT(error_of("moved=chair:10:0"), HasSubstr("\"chair:10:0\" is not OBJECT:DX:DY:DZ"));
  EXPECT_THAT(error_of("moved=chair:10:0:nan"), HasSubstr("is not OBJECT:DX:DY:DZ"));
  EXPECT_THAT(error_of("moved=chair:10:0:5000"), HasSubstr("within +-1000"));
  EXPECT_THAT(error_of("removed=throne"), HasSubstr("there is no object \"throne\" (there are: "));
  EXPECT_THAT(error_of("removed=plant/plant"), HasSubstr("there is no object \"plant\""));
  EXPECT_THAT(error_of("scene=bare,removed=plant"), HasSubstr("(there are: none)"));
  EXPECT_THAT(error_of("start=-1"), HasSubstr("start"));
}

TEST(RoomChanges, ARoomWithChangesHasAnotherSurface) {
  const SyntheticRoom room(RoomScene::kRoom),
      changed = or_throw(SyntheticRoom::create(RoomScene::kRoom, parse_removed_objects("ball")));
  const Eigen::Vector3d top_of_ball(0.95, -1.15, 0.26);
  EXPECT_NEAR(room.surface_distance(top_of_ball), 0, 1e-9);
  EXPECT_GT(changed.surface_distance(top_of_ball), 0.1);
}

}  // namespace hermite::synthetic::room_changes_test
