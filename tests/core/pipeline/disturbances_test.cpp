// What happens while somebody scans must not carry the camera away: bounds that hold from end to
// end, on small images.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "core/disturb/moving_person.h"
#include "core/evaluate/trajectory_error.h"
#include "core/pipeline/pipeline.h"
#include "core/source/open_sequence.h"
#include "tests/support/recording.h"

namespace hermite::pipeline::disturbances_test {
namespace {

struct Scanned {
  double ate_rmse_m = 0;
  std::int64_t found = 0;          // not lost
  std::int64_t tracked = 0;        // neither weak nor lost
  std::int64_t tracked_wrong = 0;  // of these: more than 5 cm from the truth
  double farthest_m = 0;           // from the truth, of those that are not lost
  output::Cloud cloud;
  std::optional<UpDirection> up;
  std::string up_problem;
};

enum class Places { kUnknown, kRecognised };

Scanned scan(const std::string& source, const Options& options = {},
             Places places = Places::kUnknown) {
  const test::Recording recording = test::record(source);
  const bool is_mapped = places == Places::kRecognised;
  Pipeline pipeline("", recording.camera, options,
                    is_mapped ? adjust::make_mapping(recording.camera, options.adjust,
                                                     adjust::CorrectionTime::kByFrames)
                              : nullptr);
  Scanned result;
  for (std::size_t i = 0; i < recording.frames.size(); ++i) {
    const Result<FrameResult> seen = pipeline.process(recording.frames[i]);
    EXPECT_TRUE(seen.ok()) << seen.error().message;
    result.found += seen.ok() && seen->status != track::TrackingStatus::kLost ? 1 : 0;
    if (!seen.ok() || seen->status == track::TrackingStatus::kLost) continue;
    const Rigid3 true_world_from_camera = inverse(recording.groundtruth[0].world_from_camera) *
                                          recording.groundtruth[i].world_from_camera;
    const double error_m =
        (seen->world_from_camera.translation - true_world_from_camera.translation).norm();
    result.farthest_m = std::max(result.farthest_m, error_m);
    if (seen->status != track::TrackingStatus::kTracked) continue;
    ++result.tracked;
    result.tracked_wrong += error_m > 0.05 ? 1 : 0;
  }
  const auto error = evaluate::trajectory_error(pipeline.trajectory(), recording.groundtruth);
  EXPECT_TRUE(error.ok());
  result.ate_rmse_m = error->ate_m.rmse;
  result.cloud = *pipeline.cloud();
  result.up = pipeline.statistics().up;
  result.up_problem = pipeline.statistics().up_problem;
  return result;
}

// Bare walls have nothing but their image to hold on to along them.
const std::string kBareWalls = "synthetic:scene=bare,frames=60,width=160,height=120,rate=20";

// Where up is in the world of the first camera; the ground truth has z upwards.
Eigen::Vector3d true_up(const std::string& source) {
  const auto sequence = *source::open_sequence(source);
  return sequence->groundtruth()[0].world_from_camera.rotation.conjugate() *
         Eigen::Vector3d::UnitZ();
}

TEST(Disturbances, AnAccelerometerKnowsUpHoweverTheCameraIsHeld) {
  const std::string room = "synthetic:frames=30,width=160,height=120,rate=10";
  for (const char* held : {"", "+turned=deg=90", "+turned=deg=180"}) {
    SCOPED_TRACE(held);
    const std::string source = room + held + "+accelerometer";
    const Scanned scanned = scan(source);
    EXPECT_EQ(scanned.found, 30);
    EXPECT_LT(scanned.ate_rmse_m, 0.005);
    ASSERT_TRUE(scanned.up) << scanned.up_problem;
    const double error_rad = std::acos(scanned.up->in_world.dot(true_up(source)));
    EXPECT_LT(error_rad, 3 * scanned.up->sigma_rad);
    EXPECT_LT(scanned.up->sigma_rad, 0.06);
  }
  const Scanned without = scan(room);
  EXPECT_FALSE(without.up);
  EXPECT_EQ(without.up_problem, "");
}

TEST(Disturbances, LightAndLensDoNotCarryTheCameraAway) {
  const Scanned undisturbed = scan(kBareWalls);
  EXPECT_LT(undisturbed.ate_rmse_m, 0.003);
  for (const char* disturbance : {"+exposure=amplitude=0.3,period_s=1", "+flicker=amplitude=0.15",
                                  "+vignetting=corner=0.5"}) {
    const Scanned disturbed = scan(kBareWalls + disturbance);
    EXPECT_LT(disturbed.ate_rmse_m, 3 * undisturbed.ate_rmse_m) << disturbance;
    EXPECT_GE(disturbed.tracked, undisturbed.tracked - 3) << disturbance;
  }
}

// Its edge is the strongest of the image, and once took the camera along by half a metre.
TEST(Disturbances, ASpotOfSunThatMovesIsNotFollowed) {
  const Scanned disturbed =
      scan("synthetic:scene=bare,frames=75,width=320,height=240,rate=15,start=20+sun");
  EXPECT_LT(disturbed.ate_rmse_m, 0.004);
  EXPECT_EQ(disturbed.tracked_wrong, 0);
  EXPECT_EQ(disturbed.found, 75);
}

// Noise of an image that shows nothing has gradients, too, which once took the camera along the
// wall by 7 cm in the first step, where depth was sure of a wrong place: 14 cm off with exact
// depth, 75 cm with a Kinect's.
TEST(Disturbances, ABlackImageTakesTheCameraNowhere) {
  const std::string black = "+dark=gain=0.01,sigma=4";
  for (const std::string& source :
       {"synthetic:scene=bare,frames=30,width=160,height=120,rate=20" + black,
        "synthetic:scene=bare,frames=8,rate=10" + black + "+noise=kinect,seed=1"}) {
    const Scanned disturbed = scan(source);
    EXPECT_EQ(disturbed.tracked_wrong, 0) << source;
    EXPECT_LT(disturbed.ate_rmse_m, 0.03) << source;
  }
}

// Depth fits everywhere along the wall that the camera sees when the hand is gone. It was believed
// to be 35 cm from where it is.
TEST(Disturbances, AfterAHandInFrontOfTheLensTheCameraIsNotFoundElsewhereOnAWall) {
  const Scanned disturbed = scan(kBareWalls + "+covered=30:14");
  EXPECT_EQ(disturbed.tracked_wrong, 0);
  EXPECT_LT(disturbed.farthest_m, 0.03);
  EXPECT_EQ(disturbed.found, 60 - 14);
}

// What is seen then fits the desk from before as well. It was tracked 1.9 m from where it is, as if
// known to 9 mm.
TEST(Disturbances, ACameraThatSeesNothingOnItsWayToADeskThatLooksTheSameIsNotSure) {
  const Scanned disturbed =
      scan("synthetic:scene=office,frames=102,width=160,height=120,rate=9+covered=58:40", {},
           Places::kRecognised);
  EXPECT_EQ(disturbed.tracked_wrong, 0);
  EXPECT_GE(disturbed.tracked, 50) << "before";
  EXPECT_GT(disturbed.farthest_m, 0.5) << "this room no longer misleads";
}

// A third of the frames end in rows of the frame before, which kept the camera back.
TEST(Disturbances, RowsLeftFromTheFrameBeforeAreNotUsed) {
  const std::string room = "synthetic:frames=60,width=160,height=120,rate=20";
  const Scanned undisturbed = scan(room), disturbed = scan(room + "+torn=every=3");
  EXPECT_LT(disturbed.ate_rmse_m, 2 * undisturbed.ate_rmse_m);
  EXPECT_EQ(disturbed.tracked_wrong, 0);
  EXPECT_EQ(disturbed.found, 60);
}

TEST(Disturbances, SomebodyWhoCrossesIsNotTheRoom) {
  const std::string room = "synthetic:frames=80,width=160,height=120,rate=20";
  const Scanned undisturbed = scan(room);
  const std::string source = room + "+person";
  const Scanned disturbed = scan(source);
  EXPECT_LT(disturbed.ate_rmse_m, 3 * undisturbed.ate_rmse_m);
  EXPECT_GE(disturbed.tracked, undisturbed.tracked - 4);
  // Where the person has been, also stands what belongs to the room.
  const auto still = *source::open_sequence(room);
  const auto stands_in_the_way = [&](const output::CloudPoint& point) {
    const Eigen::Vector3d position =
        still->groundtruth().front().world_from_camera * point.position_m.cast<double>();
    for (std::int64_t frame = 0; frame < still->frame_count(); frame += 2)
      if (disturb::person_at(*still, disturb::PersonOptions{}, frame)->contains(position, 0.02))
        return true;
    return false;
  };
  const auto in_the_way = [&](const output::Cloud& cloud) {
    return std::count_if(cloud.begin(), cloud.end(), stands_in_the_way);
  };
  EXPECT_LT(static_cast<double>(in_the_way(disturbed.cloud) - in_the_way(undisturbed.cloud)),
            0.005 * static_cast<double>(disturbed.cloud.size()));
}

// From the first frame on, and always at the same place of the view.
TEST(Disturbances, SomebodyWhoWalksAheadIsNotFollowed) {
  const std::string room = "synthetic:frames=50,width=160,height=120,rate=20";
  const Scanned undisturbed = scan(room), disturbed = scan(room + "+person=path=ahead");
  EXPECT_LT(disturbed.ate_rmse_m, 3 * undisturbed.ate_rmse_m);
  EXPECT_GE(disturbed.tracked, undisturbed.tracked - 4);
}

// He stands as still as the room at first, and is mapped.
TEST(Disturbances, SomebodyWhoBeginsToWalkIsNotFollowed) {
  const Scanned disturbed =
      scan("synthetic:frames=50,width=160,height=120,rate=20+person=path=ahead,still_s=1");
  EXPECT_LT(disturbed.ate_rmse_m, 0.004);
  EXPECT_GE(disturbed.tracked, 44);
}

// Once as the room sees it, in which a plate turns, and once as the plate does.
TEST(Disturbances, WhatTurnsIsLeftOutOrAllThatIsScanned) {
  const std::string turntable = "synthetic:scene=turntable,frames=16,width=320,height=240,rate=10";
  Options options;
  options.track.object = true;
  const Scanned object = scan(turntable, options);
  EXPECT_LT(object.ate_rmse_m, 0.02);  // with the frames before the first turn was seen
  EXPECT_GE(object.tracked, 12);
  const auto is_wall = [](const output::CloudPoint& point) {
    return point.position_m.norm() > 1.5f;
  };
  const auto of_wall = std::count_if(object.cloud.begin(), object.cloud.end(), is_wall);
  EXPECT_LT(static_cast<double>(of_wall), 0.02 * static_cast<double>(object.cloud.size()));
  EXPECT_GT(object.cloud.size(), 200u);
}

// Depth in blobs on what has texture, as of stereo: corners lead the way, and say that a frame with
// few points is held.
TEST(Disturbances, LittleDepthIsEnough) {
  const Scanned disturbed =
      scan("synthetic:frames=30,width=320,height=240,rate=20+sparse=keep=0.1");
  EXPECT_LT(disturbed.ate_rmse_m, 0.005);
  EXPECT_EQ(disturbed.found, 30);
  EXPECT_GE(disturbed.tracked, 12)
      << "the others are uncertain: the camera was not seen to fit, and little holds it";
}

// A quarter of the pixels is looked at: the way that cameras of 640x480 go.
TEST(Disturbances, AFullSizeCameraIsFollowedThroughThem) {
  const Scanned disturbed = scan(
      "synthetic:scene=bare,frames=16,rate=10+exposure=amplitude=0.25,period_s=1+vignetting=corner="
      "0.7");
  EXPECT_LT(disturbed.ate_rmse_m, 0.003);
  EXPECT_EQ(disturbed.found, 16);
  EXPECT_GE(disturbed.tracked, 6)
      << "the others are uncertain: the camera was not seen to fit, and bare walls hold it little";
}

}  // namespace
}  // namespace hermite::pipeline::disturbances_test
