#include "core/calibrate/camera_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "core/calibrate/view_choice.h"
#include "core/dataset/camera_velocity.h"
#include "core/source/open_sequence.h"

namespace hermite::calibrate {
namespace {

constexpr const char* kHall = "synthetic:scene=bare,frames=120,width=320,height=240";

// A camera that is moved fast.
constexpr const char* kRun = "synthetic:speed=2,frames=90,width=320,height=240";

// Views by poses that were led astray, as a tracker's are by a wrong camera: 5 cm and 2 degrees by
// the last. The velocity of the camera is that of the true poses, if it is known.
std::vector<CalibrationView> views_of(const std::string& disturbance, std::size_t count,
                                      const char* source = kHall, bool has_velocities = false) {
  const auto sequence = *source::open_sequence(source + disturbance + "+noise=kinect-white,seed=1");
  const dataset::Trajectory truth = sequence->groundtruth();
  std::vector<CalibrationView> views;
  for (const ChosenFrame& chosen :
       choose_frames(*sequence, {0, sequence->frame_count()}, truth, count)) {
    const frame::RgbdFrame frame = *dataset::decode_frame(*sequence->read(chosen.index));
    const double share = static_cast<double>(views.size()) / static_cast<double>(count);
    const Rigid3 astray =
        exp_se3((Vector6d() << 0.03, -0.02, 0.035, 0.01, 0.03, -0.01).finished() * share);
    views.push_back({chosen.world_from_camera * astray, patches_of(frame.depth, sequence->camera()),
                     adjust::detect_features(frame, sequence->camera())});
    if (has_velocities)
      views.back().known_twist_per_s =
          dataset::twist_per_s_at(truth, sequence->timestamp_s(chosen.index));
  }
  return views;
}

Camera camera_of(const std::string& disturbance) {
  return (*source::open_sequence(kHall + disturbance))->camera();
}

TEST(CameraCheck, SaysThatARightCameraFits) {
  const CameraCheck check = check_camera(views_of("", 14), camera_of(""));
  EXPECT_EQ(check.verdict, CameraVerdict::kFits);
  ASSERT_TRUE(check.measured);
  EXPECT_EQ(check.measured->errors.focal, 0);
  EXPECT_EQ(check.measured->deviations.focal, kFitting.focal);
}

TEST(CameraCheck, FindsAFocalLengthThatIsOff) {
  const CameraCheck found =
      check_camera(views_of("+focal=percent=2", 14), camera_of("+focal=percent=2"));
  EXPECT_EQ(found.verdict, CameraVerdict::kIsOff);
  EXPECT_NEAR(found.change[kFocal], -0.0198, 0.002);
  EXPECT_EQ(found.change[kBend], 0);
}

// What a file of another camera states, or one of another size of the image.
TEST(CameraCheck, FindsTheFocalLengthOfAnotherCamera) {
  for (const double percent : {15.0, -15.0}) {
    const std::string off = "+focal=percent=" + std::to_string(percent);
    const CameraCheck found = check_camera(views_of(off, 14), camera_of(off));
    EXPECT_EQ(found.verdict, CameraVerdict::kIsOff) << off;
    EXPECT_NEAR(found.change[kFocal], -std::log(1 + percent / 100), 0.008) << off;
    EXPECT_EQ(found.change[kBend], 0) << off;
    ASSERT_TRUE(found.measured) << off;
    EXPECT_GT(found.measured->deviations.focal, kFitting.focal) << "more of it may be left";
  }
}

TEST(CameraCheck, FindsABendOfDepth) {
  const CameraCheck found =
      check_camera(views_of("+bend=percent=2", 14), camera_of("+bend=percent=2"));
  EXPECT_EQ(found.verdict, CameraVerdict::kIsOff);
  EXPECT_EQ(found.change[kFocal], 0);
  EXPECT_NEAR(found.change[kBend], 1 / 1.02 - 1, 0.002);
}

TEST(CameraCheck, FindsALensThatDistorts) {
  const std::vector<CalibrationView> views = views_of("+lens=k1=-0.04", 14);
  const CameraCheck found = check_camera(views, camera_of(""));
  EXPECT_EQ(found.verdict, CameraVerdict::kIsOff);
  EXPECT_NEAR(found.change[kRadial], -0.04, 0.004);
  EXPECT_EQ(found.change[kFocal], 0);
  EXPECT_EQ(found.change[kBend], 0);
  // Registered images of two lenses do not tell which of them distorts.
  EXPECT_EQ(check_camera(views, camera_of(""), Lenses::kTwo).change[kRadial], 0);
}

// Together they look like a focal length 2 to 3 % off.
TEST(CameraCheck, FindsALensBesideABend) {
  const char* both = "+lens=k1=-0.03+bend=percent=1.5";
  const CameraCheck found = check_camera(views_of(both, 16), camera_of(""));
  EXPECT_EQ(found.verdict, CameraVerdict::kIsOff);
  EXPECT_NEAR(found.change[kRadial], -0.03, 0.005);
  EXPECT_NEAR(found.change[kBend], 1 / 1.015 - 1, 0.002);
  EXPECT_EQ(found.change[kFocal], 0);
}

TEST(CameraCheck, FindsARollingShutterAndLateColour) {
  const CameraCheck rolling =
      check_camera(views_of("+rolling=ms=30", 16, kRun, true), camera_of(""));
  EXPECT_EQ(rolling.verdict, CameraVerdict::kIsOff);
  EXPECT_NEAR(rolling.change[kDepthReadout], 0.030, 0.006);  // a fifth
  EXPECT_NEAR(rolling.change[kColorReadout], 0.030, 0.006);
  EXPECT_EQ(rolling.change.head<kDepthReadout>().norm(), 0) << "nothing else is off";
  EXPECT_EQ(rolling.change[kColorDelay], 0);
  ASSERT_TRUE(rolling.measured) << "what is known of its shape, which was not changed";
  EXPECT_LE(std::abs(rolling.measured->errors.focal), 2 * rolling.measured->deviations.focal);
}

// With so few views the colour's rows are not confirmed, which is no reason to keep a wrong focal
// length.
TEST(CameraCheck, FindsAFocalLengthBesideARollingShutter) {
  const char* both = "+focal=percent=1+rolling=ms=30";
  const CameraCheck found = check_camera(views_of(both, 16, kRun, true), camera_of(both));
  EXPECT_EQ(found.verdict, CameraVerdict::kIsOff);
  EXPECT_NEAR(found.change[kFocal], -0.00995, 0.002);
  EXPECT_EQ(found.change[kBend], 0);
  ASSERT_TRUE(found.measured);
  EXPECT_EQ(found.measured->deviations.focal, kFitting.focal) << "the corrected camera fits";
}

TEST(CameraCheck, SaysNothingOfTheTimingOfACameraWhoseVelocityIsUnknown) {
  const CameraCheck rolling = check_camera(views_of("+rolling=ms=30", 16, kRun), camera_of(""));
  EXPECT_EQ(rolling.change[kDepthReadout], 0);
}

TEST(CameraCheck, SaysNothingOfTheTimingOfACameraThatTakesAllAtOnce) {
  const CameraCheck check = check_camera(views_of("", 16, kRun, true), camera_of(""));
  EXPECT_NE(check.verdict, CameraVerdict::kIsOff);
}

// It stands for something that no camera is.
TEST(CameraCheck, SaysNothingOfViewsThatContradictEachOther) {
  std::vector<CalibrationView> views = views_of("+bend=percent=2", 14);
  const std::vector<CalibrationView> others = views_of("", 14);
  std::copy(others.begin() + 7, others.end(), views.begin() + 7);
  EXPECT_EQ(check_camera(views, camera_of("")).verdict, CameraVerdict::kUnknown);
}

TEST(CameraCheck, SaysNothingOfFewViews) {
  EXPECT_EQ(check_camera(views_of("+focal=percent=2", 5), camera_of("+focal=percent=2")).verdict,
            CameraVerdict::kUnknown);
  EXPECT_EQ(check_camera({}, camera_of("")).verdict, CameraVerdict::kUnknown);
}

}  // namespace
}  // namespace hermite::calibrate
