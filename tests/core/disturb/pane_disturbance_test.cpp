#include "core/disturb/pane_disturbance.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/source/open_sequence.h"
#include "core/synthetic/synthetic_room.h"

namespace hermite::disturb {
namespace {

using Eigen::Vector3d;
using testing::HasSubstr;

const std::string kPaneRoom = "synthetic:frames=61,rate=12,width=160,height=120";
constexpr std::int64_t kMiddle = 30;

// Both frames, and the pane, in the world.
struct Compared {
  DepthImage before, after;
  ColorImage color_before, color_after;
  Pane pane;
  Camera camera;
  Rigid3 world_from_camera;

  Vector3d point_world(const DepthImage& depth, int x, int y) const {
    return world_from_camera *
           camera.unproject(x, y, depth.at(x, y) / camera.depth_units_per_metre);
  }
  // Whether the pane lies between the camera and what the frame showed there.
  bool is_behind_pane(int x, int y) const {
    const Vector3d end = point_world(before, x, y), way = end - world_from_camera.translation;
    const double share =
        (pane.middle_world - world_from_camera.translation).dot(pane.normal_world) /
        way.dot(pane.normal_world);
    const Vector3d at = world_from_camera.translation + share * way - pane.middle_world;
    return share > 0 && share < 1 && std::abs(at.dot(pane.across_world)) < pane.half_width_m &&
           std::abs(at.dot(pane.up_world)) < pane.half_height_m;
  }
};

Compared compare(const std::string& suffix, const PaneOptions& options,
                 std::int64_t index = kMiddle) {
  const auto room = *source::open_sequence(kPaneRoom);
  const frame::RgbdFrame before = *dataset::decode_frame(*room->read(index)),
                         after = *dataset::decode_frame(
                             *(*source::open_sequence(kPaneRoom + suffix))->read(index));
  return {before.depth,
          after.depth,
          before.color,
          after.color,
          *pane_in(*room, options),
          room->camera(),
          room->groundtruth()[static_cast<std::size_t>(index)].world_from_camera};
}

void for_each_pixel(const std::function<void(int, int)>& work) {
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) work(x, y);
}

TEST(PaneDisturbance, StandsUprightWhereItIsAskedFor) {
  const auto room = *source::open_sequence(kPaneRoom);
  const Pane pane = *pane_in(*room, *parse_mirror("distance_m=1.2,turn_deg=30"));
  const Rigid3 camera_from_world = inverse(room->groundtruth()[kMiddle].world_from_camera);
  EXPECT_LT((camera_from_world * pane.middle_world - Vector3d(0, 0, 1.2)).norm(), 1e-9);
  EXPECT_EQ(pane.up_world, Vector3d::UnitZ());
  const Vector3d forward =
      room->groundtruth()[kMiddle].world_from_camera.rotation * Vector3d::UnitZ();
  const double heading = std::atan2(forward.y(), forward.x()),
               facing = std::atan2(-pane.normal_world.y(), -pane.normal_world.x());
  EXPECT_NEAR(std::remainder(facing - heading, 2 * M_PI) * 180 / M_PI, -30, 1e-6)
      << "its back looks right, its face left";
}

TEST(PaneDisturbance, AMirrorShowsTheRoomMirrored) {
  const Compared seen = compare("+mirror", *parse_mirror(""));
  const synthetic::SyntheticRoom room(synthetic::RoomScene::kRoom);
  int in_mirror = 0, shown = 0, on_surface = 0;
  for_each_pixel([&](int x, int y) {
    if (!seen.is_behind_pane(x, y)) {
      EXPECT_EQ(seen.after.at(x, y), seen.before.at(x, y)) << x << " " << y;
      return;
    }
    ++in_mirror;
    if (seen.after.at(x, y) == 0) return;
    ++shown;
    const Vector3d point = seen.point_world(seen.after, x, y);
    EXPECT_LT((point - seen.pane.middle_world).dot(seen.pane.normal_world), 0)
        << "behind the mirror";
    on_surface += room.surface_distance(seen.pane.mirrored(point)) < 0.01 ? 1 : 0;
  });
  EXPECT_GT(in_mirror, 0.05 * 160 * 120);
  EXPECT_GT(shown, 0.6 * in_mirror) << "the rest no frame has seen";
  EXPECT_GT(on_surface, 0.95 * shown);
  EXPECT_NE(seen.color_after, seen.color_before);
}

TEST(PaneDisturbance, AMirrorIsNotThereFromBehind) {
  // From the opposite side of its lap the camera looks at the back of a mirror that stands a little
  // in front of the room's middle.
  const auto lap = [](const std::string& suffix) {
    return (*source::open_sequence("synthetic:frames=121,rate=12,width=96,height=72" + suffix))
        ->read(0)
        ->depth;
  };
  EXPECT_EQ(lap("+mirror=distance_m=0.5,turn_deg=0"), lap(""));
  EXPECT_NE(lap("+glass=distance_m=0.5"), lap("")) << "glass has two sides";
}

TEST(PaneDisturbance, GlassIsSeenThroughInPart) {
  const Compared seen = compare("+glass=holes=0.4,specks=0.1", *parse_glass(""));
  int behind = 0, holes = 0, specks = 0;
  for_each_pixel([&](int x, int y) {
    if (seen.after.at(x, y) == seen.before.at(x, y)) {
      behind += seen.is_behind_pane(x, y) ? 1 : 0;
      return;
    }
    EXPECT_TRUE(seen.is_behind_pane(x, y)) << x << " " << y;
    ++behind;
    if (seen.after.at(x, y) == 0) {
      ++holes;
      return;
    }
    ++specks;
    const Vector3d from_pane = seen.point_world(seen.after, x, y) - seen.pane.middle_world;
    EXPECT_NEAR(from_pane.dot(seen.pane.normal_world), 0, 0.001) << "on the pane";
  });
  EXPECT_GT(behind, 0.2 * 160 * 120);
  EXPECT_NEAR(specks / static_cast<double>(behind), 0.1, 0.02);
  EXPECT_NEAR(holes / static_cast<double>(behind), 0.4 * 0.9, 0.08);
  EXPECT_EQ(seen.color_after, seen.color_before);
}

TEST(PaneDisturbance, DirtStaysOnTheGlassAndHolesDoNot) {
  const std::string still = "synthetic:speed=0.05,rate=240,frames=3,width=160,height=120";
  const auto changed = [&](const std::string& suffix, std::int64_t index) {
    const DepthImage before = (*source::open_sequence(still))->read(index)->depth,
                     after = (*source::open_sequence(still + suffix))->read(index)->depth;
    std::vector<bool> is_changed;
    for (std::size_t i = 0; i < before.pixels.size(); ++i)
      is_changed.push_back(before.pixels[i] != after.pixels[i]);
    return is_changed;
  };
  const auto differing = [&](const std::string& suffix) {
    const std::vector<bool> first = changed(suffix, 0), second = changed(suffix, 1);
    int differing = 0;
    for (std::size_t i = 0; i < first.size(); ++i) differing += first[i] != second[i] ? 1 : 0;
    return differing / static_cast<double>(std::count(first.begin(), first.end(), true));
  };
  EXPECT_LT(differing("+glass=holes=0,specks=0.3"), 0.1);
  EXPECT_GT(differing("+glass=holes=0.3,specks=0"), 1.0);
  EXPECT_NE(changed("+glass=seed=2", 0), changed("+glass", 0));
  EXPECT_EQ(changed("+glass=seed=1", 0), changed("+glass", 0));
}

TEST(PaneDisturbance, AScreenStandsStillAndItsPictureMoves) {
  const std::string screen = kPaneRoom + "+screen=speed_m_s=0.5";
  const auto room = *source::open_sequence(kPaneRoom), with_screen = *source::open_sequence(screen);
  const Camera& camera = room->camera();
  for (const std::int64_t index : {kMiddle - 3, kMiddle + 3}) {
    const frame::RgbdFrame frame = *dataset::decode_frame(*with_screen->read(index));
    const Rigid3 world_from_camera =
        room->groundtruth()[static_cast<std::size_t>(index)].world_from_camera;
    const Pane pane = *pane_in(*room, PaneOptions{.width_m = 1.2, .height_m = 0.7});
    const Vector3d seen =
        world_from_camera *
        camera.unproject(80, 60, frame.depth.at(80, 60) / camera.depth_units_per_metre);
    EXPECT_LT(std::abs((seen - pane.middle_world).dot(pane.normal_world)), 0.002);
  }
  const auto standing = *source::open_sequence(kPaneRoom + "+screen=speed_m_s=0");
  EXPECT_EQ(with_screen->read(kMiddle)->depth, standing->read(kMiddle)->depth);
  EXPECT_NE(dataset::decode_frame(*with_screen->read(kMiddle))->color,
            dataset::decode_frame(*standing->read(kMiddle))->color);
}

TEST(PaneDisturbance, ADoorSwingsAboutItsEdgeAndCloses) {
  const auto room = *source::open_sequence(kPaneRoom),
             door = *source::open_sequence(kPaneRoom + "+door=swing_deg=60,period_s=5");
  const Camera& camera = room->camera();
  const PaneOptions closed{.width_m = 0.9, .height_m = 2};
  const Pane pane = *pane_in(*room, closed);
  // How far in front of or behind the closed door the pixels are that the door has changed, at
  // most.
  const auto away_m = [&](std::int64_t index) {
    const DepthImage before = room->read(index)->depth, after = door->read(index)->depth;
    const Rigid3 world_from_camera =
        room->groundtruth()[static_cast<std::size_t>(index)].world_from_camera;
    double most_m = 0;
    for_each_pixel([&](int x, int y) {
      if (before.at(x, y) == after.at(x, y)) return;
      const Vector3d seen =
          world_from_camera * camera.unproject(x, y, after.at(x, y) / camera.depth_units_per_metre);
      most_m = std::max(most_m, std::abs((seen - pane.middle_world).dot(pane.normal_world)));
    });
    return most_m;
  };
  EXPECT_LT(away_m(0), 0.002) << "closed at first";
  EXPECT_GT(away_m(kMiddle), 0.5) << "12 frames a second: widest open";
  EXPECT_LT(away_m(60), 0.002);
}

TEST(PaneDisturbance, NonsenseIsAnErrorWithAMessage) {
  const auto error_of = [](const std::string& suffix) {
    const auto opened = source::open_sequence(kPaneRoom + suffix);
    return opened.ok() ? "opened" : opened.error().message;
  };
  EXPECT_THAT(error_of("+mirror=width_m=0"),
              HasSubstr("mirror: option width_m is \"0\", allowed is a number from 0.1 to 10"));
  EXPECT_THAT(error_of("+mirror=turn_deg=90"), HasSubstr("from -80 to 80"));
  EXPECT_THAT(error_of("+mirror=holes=0.5"), HasSubstr("mirror: there is no option \"holes\""));
  EXPECT_THAT(error_of("+glass=holes=1.5"),
              HasSubstr("glass: option holes is \"1.5\", allowed is a number from 0 to 1"));
  EXPECT_THAT(error_of("+glass=distance_m=0.1"), HasSubstr("from 0.3 to 10"));
  EXPECT_THAT(error_of("+screen=speed_m_s=11"), HasSubstr("screen: option speed_m_s"));
  EXPECT_THAT(error_of("+door=swing_deg=180"), HasSubstr("door: option swing_deg"));
}

}  // namespace
}  // namespace hermite::disturb
