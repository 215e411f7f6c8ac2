#include "core/synthetic/synthetic_camera.h"
#include "core/source/open_sequence.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace hermite::synthetic {
namespace {

using testing::HasSubstr;

constexpr double kDegrees = 180 / M_PI;
const char* const kSmall = "synthetic:frames=300,width=80,height=64";

TEST(SyntheticCamera, DefaultsAreALapAtThirtyHertz) {
  const auto opened = source::open_sequence("synthetic");
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  const dataset::Sequence& sequence = **opened;
  EXPECT_EQ(sequence.format(), "synthetic");
  EXPECT_EQ(sequence.frame_count(), 300);
  EXPECT_EQ(sequence.frame_rate_hz(), 30);
  EXPECT_EQ(sequence.camera(), (Camera{640, 480, 525, 525, 319.5, 239.5, 5000}));
  EXPECT_EQ(sequence.groundtruth().size(), 300u);
  EXPECT_EQ(sequence.groundtruth()[7].timestamp_s, sequence.timestamp_s(7));
}

TEST(SyntheticCamera, AHandsSpeedAndAClosedSmoothLap) {
  constexpr double kStep_s = 1 / 30.0;
  double fastest = 0, slowest = 1e9, fastest_turn = 0, largest_jerk = 0;
  for (int i = 1; i < 600; ++i) {
    const Rigid3 before = synthetic_pose((i - 1) * kStep_s, 1),
                 here = synthetic_pose(i * kStep_s, 1),
                 after = synthetic_pose((i + 1) * kStep_s, 1);
    const double speed = (after.translation - here.translation).norm() / kStep_s;
    fastest = std::max(fastest, speed);
    slowest = std::min(slowest, speed);
    fastest_turn = std::max(
        fastest_turn, angle_rad(here.rotation.conjugate() * after.rotation) / kStep_s * kDegrees);
    const Eigen::Vector3d acceleration =
        (after.translation - 2 * here.translation + before.translation) / (kStep_s * kStep_s);
    largest_jerk = std::max(largest_jerk, acceleration.norm());
  }
  EXPECT_GT(slowest, 0.25);
  EXPECT_LT(fastest, 0.6);
  EXPECT_LT(fastest_turn, 40);
  EXPECT_LT(largest_jerk, 1.0) << "m/s^2: a hand, no jolt";
  for (const double laps : {1.0, 2.0}) {
    const Rigid3 start = synthetic_pose(0, 1), end = synthetic_pose(10 * laps, 1);
    EXPECT_LT((end.translation - start.translation).norm(), 1e-9);
    EXPECT_LT(angle_rad(start.rotation.conjugate() * end.rotation) * kDegrees, 1e-6);
  }
}

TEST(SyntheticCamera, SpeedAndRateScaleTimeNotThePath) {
  const Rigid3 slow = synthetic_pose(4, 0.5), fast = synthetic_pose(2, 1);
  EXPECT_LT((slow.translation - fast.translation).norm(), 1e-12);
  const auto longer = source::open_sequence("synthetic:frames=900,width=80,height=64"),
             faster = source::open_sequence("synthetic:rate=60,width=80,height=64");
  const auto normal = source::open_sequence(kSmall);
  EXPECT_EQ((*longer)->groundtruth()[100].world_from_camera.translation,
            (*normal)->groundtruth()[100].world_from_camera.translation)
      << "more frames keep the speed";
  EXPECT_LT(((*faster)->groundtruth()[200].world_from_camera.translation -
             (*normal)->groundtruth()[100].world_from_camera.translation)
                .norm(),
            1e-12);
}

TEST(SyntheticCamera, LooksAtThingsSixtyCentimetresToFourMetresAway) {
  const auto opened = source::open_sequence("synthetic:frames=600,width=80,height=64");
  for (int i = 0; i < 600; i += 15) {
    const auto frame = (*opened)->read(i);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    const auto [nearest, farthest] =
        std::minmax_element(frame->depth.pixels.begin(), frame->depth.pixels.end());
    EXPECT_GE(*nearest, 0.6 * 5000) << i;
    EXPECT_LE(*farthest, 4.1 * 5000) << i;
  }
}

TEST(SyntheticCamera, FramesDependOnTheirIndexOnly) {
  const auto one = source::open_sequence("synthetic:width=80,height=64,noise=kinect,seed=4"),
             other = source::open_sequence("synthetic:width=80,height=64,noise=kinect,seed=4");
  const auto first = (*one)->read(20);
  (*other)->read(3).ok();
  const auto again = (*other)->read(20);
  EXPECT_EQ(first->depth, again->depth);
  EXPECT_EQ(first->color_bytes, again->color_bytes);
  EXPECT_EQ(first->timestamp_s, 20 / 30.0);
  EXPECT_NE(first->depth,
            (*source::open_sequence("synthetic:width=80,height=64,noise=kinect,seed=5"))
                ->read(20)
                ->depth);
}

TEST(SyntheticCamera, NoiseComesOnTopOfTheCleanDepth) {
  const auto clean = (*source::open_sequence(kSmall))->read(10),
             noisy = (*source::open_sequence(std::string(kSmall) + ",noise=gaussian,sigma_mm=10"))
                         ->read(10);
  double sum2 = 0;
  for (std::size_t i = 0; i < clean->depth.pixels.size(); ++i) {
    const double difference_m = (noisy->depth.pixels[i] - clean->depth.pixels[i]) / 5000.0;
    sum2 += difference_m * difference_m;
  }
  EXPECT_NEAR(std::sqrt(sum2 / static_cast<double>(clean->depth.pixels.size())), 0.010, 0.0006);
}

TEST(SyntheticCamera, ColourComesAsAJpegThatDecodes) {
  auto frame = (*source::open_sequence(kSmall))->read(0);
  ASSERT_TRUE(frame.ok());
  ASSERT_GE(frame->color_bytes.size(), 2u);
  EXPECT_EQ(frame->color_bytes[0], 0xff);
  EXPECT_EQ(frame->color_bytes[1], 0xd8);
  EXPECT_TRUE(dataset::decode_frame(std::move(*frame)).ok());
}

TEST(SyntheticCamera, AGivenCameraIsUsed) {
  const Camera camera{100, 80, 90, 91, 50, 40, 1000};
  const auto opened = source::open_sequence("synthetic:frames=2", camera);
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  EXPECT_EQ((*opened)->camera(), camera);
  EXPECT_EQ((*opened)->read(1)->depth.width, 100);
}

TEST(SyntheticCamera, EverySceneHasItsOwnPath) {
  for (const auto& [name, scene] :
       {std::pair("loop", RoomScene::kLoop), std::pair("twins", RoomScene::kTwins),
        std::pair("office", RoomScene::kOffice), std::pair("blank", RoomScene::kBlank)}) {
    const auto opened =
        source::open_sequence("synthetic:frames=40,width=80,height=64,scene=" + std::string(name));
    ASSERT_TRUE(opened.ok()) << opened.error().message;
    EXPECT_EQ((*opened)->groundtruth()[31].world_from_camera.translation,
              synthetic_pose(31 / 30.0, 1, scene).translation)
        << name;
    EXPECT_EQ(synthetic_pose(3, 2, scene).translation, synthetic_pose(6, 1, scene).translation)
        << name;
    EXPECT_GT(synthetic_lap_s(scene), 30) << name;
    EXPECT_TRUE((*opened)->read(31).ok()) << name;
  }
  EXPECT_EQ(synthetic_lap_s(RoomScene::kRoom), 10);
  EXPECT_EQ(synthetic_pose(3, 1).translation, synthetic_pose(3, 1, RoomScene::kBare).translation);
}

// Nothing but what is on the plate moves in the image, and that lies still in the frame of the
// ground truth.
TEST(SyntheticCamera, OnATurntableTheTruthIsInTheFrameOfWhatTurns) {
  const auto opened =
      source::open_sequence("synthetic:scene=turntable,frames=150,width=160,height=120");
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  const dataset::Sequence& sequence = **opened;
  const auto first = sequence.read(0), last = sequence.read(149);
  const Rigid3 &world_from_first = sequence.groundtruth()[0].world_from_camera,
               &world_from_last = sequence.groundtruth()[149].world_from_camera;
  EXPECT_NEAR(
      angle_rad(world_from_first.rotation.conjugate() * world_from_last.rotation) * kDegrees,
      360 / 20.0 * 149 / 30, 1e-6);
  EXPECT_EQ(sequence.name(), "synthetic turntable");
  EXPECT_EQ(synthetic_lap_s(RoomScene::kTurntable), 20);
  const SyntheticRoom room(RoomScene::kTurntable);
  const auto is_on_plate = [](const Eigen::Vector3d& point) {
    return point.head<2>().norm() < 0.26 && point.z() > 0.752;
  };
  int on_plate = 0, changed = 0;
  for (int y = 0; y < 120; ++y)
    for (int x = 0; x < 160; ++x) {
      const Eigen::Vector3d before = world_from_first * sequence.camera().unproject(
                                                            x, y, first->depth.at(x, y) / 5000.0),
                            after = world_from_last * sequence.camera().unproject(
                                                          x, y, last->depth.at(x, y) / 5000.0);
      if (!is_on_plate(before) && !is_on_plate(after)) {
        EXPECT_EQ(first->depth.at(x, y), last->depth.at(x, y)) << x << " " << y;
        continue;
      }
      changed += first->depth.at(x, y) != last->depth.at(x, y) ? 1 : 0;
      if (!is_on_plate(after)) continue;
      ++on_plate;
      EXPECT_LT(room.surface_distance(after), 0.0003) << x << " " << y;
    }
  EXPECT_GT(on_plate, 0.08 * 160 * 120);
  EXPECT_GT(changed, 0.3 * on_plate);
}

TEST(SyntheticCamera, BeforeThePosterIsAMetreAwayFromItsWords) {
  const auto opened = source::open_sequence("synthetic:scene=poster,frames=300,width=80,height=64");
  ASSERT_TRUE(opened.ok()) << opened.error().message;
  for (int i = 0; i < 300; i += 60) {
    const DepthImage depth = (*opened)->read(i)->depth;
    EXPECT_NEAR(depth.at(40, 32) / 5000.0, 0.985, 0.06) << i;
  }
  EXPECT_EQ(synthetic_lap_s(RoomScene::kPoster), 10);
}

TEST(SyntheticCamera, BadOptionsNameKeyAndRange) {
  const auto error_of = [](const std::string& options) {
    const auto opened = source::open_sequence("synthetic:" + options);
    return opened.ok() ? std::string("opened") : opened.error().message;
  };
  EXPECT_THAT(error_of("frames=0"),
              HasSubstr("option frames is \"0\", allowed is a whole number from 1 to 1000000"));
  EXPECT_THAT(error_of("width=32"),
              HasSubstr("option width is \"32\", allowed is a whole number from 64 to 2048"));
  EXPECT_THAT(error_of("height=4096"), HasSubstr("option height"));
  EXPECT_THAT(error_of("rate=0"), HasSubstr("option rate"));
  EXPECT_THAT(error_of("speed=nan"),
              HasSubstr("option speed is \"nan\", allowed is a number from 0.05 to 5"));
  EXPECT_THAT(
      error_of("noise=pink"),
      HasSubstr("option noise is \"pink\", allowed is none, gaussian, kinect or kinect-white"));
  EXPECT_THAT(error_of("noise=gaussian,sigma_mm=-1"), HasSubstr("sigma_mm"));
  EXPECT_THAT(error_of("sigma_mm=3"), HasSubstr("there is no option \"sigma_mm\""));
  EXPECT_THAT(error_of("scene=castle"),
              HasSubstr("option scene is \"castle\", allowed is room, bare, loop, twins, office, "
                        "blank, turntable or poster"));
  EXPECT_THAT(error_of("colour=red"),
              HasSubstr("there is no option \"colour\" (there are: frames"));
  EXPECT_THAT(error_of("frames"), HasSubstr("is not key=value"));
  EXPECT_EQ(error_of(""), "opened");
  EXPECT_EQ(error_of("scene=bare,frames=2"), "opened");
  EXPECT_THAT(error_of("width=2048,height=64"), HasSubstr("synthetic camera: camera.fy is"));
}

}  // namespace
}  // namespace hermite::synthetic
