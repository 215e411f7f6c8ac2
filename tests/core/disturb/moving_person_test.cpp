#include "core/disturb/moving_person.h"
#include "core/source/open_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::disturb {
namespace {

using testing::HasSubstr;

const std::string kRoom = "synthetic:frames=61,width=96,height=72";

// Pixels whose depth the person has changed, as a share of all; each is nearer than what was there,
// and inside the person's skin.
double share_of_view(const std::string& suffix, std::int64_t index, const PersonOptions& options) {
  const auto room = *source::open_sequence(kRoom), crowded = *source::open_sequence(kRoom + suffix);
  const DepthImage before = room->read(index)->depth, after = crowded->read(index)->depth;
  const Person person = *person_at(*room, options, index);
  const Rigid3 world_from_camera =
      room->groundtruth()[static_cast<std::size_t>(index)].world_from_camera;
  const Camera& camera = room->camera();
  int changed = 0;
  for (int y = 0; y < 72; ++y)
    for (int x = 0; x < 96; ++x) {
      if (after.at(x, y) == before.at(x, y)) continue;
      ++changed;
      const double depth_m = after.at(x, y) / camera.depth_units_per_metre;
      const Eigen::Vector3d point =
          depth_m * Eigen::Vector3d((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
      EXPECT_TRUE(person.contains(world_from_camera * point, 0.002)) << x << " " << y;
      EXPECT_FALSE(person.contains(world_from_camera * point, -0.002)) << x << " " << y;
      EXPECT_TRUE(before.at(x, y) == 0 || after.at(x, y) < before.at(x, y)) << x << " " << y;
    }
  return changed / (96.0 * 72.0);
}

TEST(MovingPerson, CrossesTheViewInTheMiddleOfTheSequence) {
  EXPECT_GT(share_of_view("+person", 30, {}), 0.1);
  const auto room = *source::open_sequence(kRoom);
  const double walked_m =
      (person_at(*room, {}, 45)->head_world - person_at(*room, {}, 15)->head_world).norm();
  EXPECT_NEAR(walked_m, 0.8, 0.01) << "in a second";
}

TEST(MovingPerson, WalksAheadWhereverTheCameraGoes) {
  const PersonOptions options = *parse_person("path=ahead");
  EXPECT_EQ(options.distance_m, 1.7);
  for (const std::int64_t index : {0, 30, 60})
    EXPECT_GT(share_of_view("+person=path=ahead", index, options), 0.1) << index;
}

TEST(MovingPerson, StandsAtFirstWhereTheWalkBegins) {
  const auto room = *source::open_sequence(kRoom);
  for (const std::string path : {"cross", "ahead"}) {
    const PersonOptions options = *parse_person("still_s=1,path=" + path),
                        walks = *parse_person("path=" + path);
    EXPECT_EQ(person_at(*room, options, 0)->head_world, person_at(*room, options, 30)->head_world)
        << path;
    EXPECT_NE(person_at(*room, options, 31)->head_world, person_at(*room, options, 30)->head_world)
        << path;
    EXPECT_EQ(person_at(*room, options, 45)->head_world, person_at(*room, walks, 45)->head_world)
        << path;
  }
}

TEST(MovingPerson, WearsWhatIsAskedFor) {
  const auto color = [](const std::string& suffix) {
    return dataset::decode_frame(*(*source::open_sequence(kRoom + suffix))->read(30))->color;
  };
  EXPECT_NE(color("+person"), color(""));
  EXPECT_NE(color("+person=clothes=plain"), color("+person"));
  EXPECT_EQ(color("+person=clothes=checked"), color("+person"));
}

TEST(MovingPerson, NonsenseIsAnErrorWithAMessage) {
  const auto error_of = [](const std::string& suffix) {
    const auto opened = source::open_sequence(kRoom + suffix);
    return opened.ok() ? "opened" : opened.error().message;
  };
  EXPECT_THAT(error_of("+person=path=away"),
              HasSubstr("person: option path is \"away\", allowed is cross or ahead"));
  EXPECT_THAT(error_of("+person=distance_m=0.1"), HasSubstr("from 0.6 to 10"));
}

}  // namespace
}  // namespace hermite::disturb
