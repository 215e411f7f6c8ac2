#include "core/pipeline/rolling_shutter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/evaluate/trajectory_error.h"
#include "core/pipeline/frame_preparer.h"
#include "core/pipeline/pipeline.h"
#include "tests/support/gpu_test.h"
#include "tests/support/recording.h"

namespace hermite::pipeline::rolling_shutter_test {
namespace {

constexpr ImageTiming kTiming{0.030, 0.030, 0.008};
constexpr double kFrame_s = 1.0 / 30;
const Camera kCamera = [] {
  Camera camera{320, 240, 262, 262, 159.5, 119.5, 5000};
  camera.timing = kTiming;
  return camera;
}();

// Corners that a camera moving steadily shows at the times of their rows.
track::FeatureMotion corners_of(const Vector6d& twist_per_s) {
  track::FeatureMotion motion;
  motion.camera = rectified(kCamera);
  for (int i = 0; i < 60; ++i) {
    const Eigen::Vector3d point_m(0.25 * (i % 10) - 1.1, 0.3 * (i / 10) - 0.75, 2 + 0.1 * (i % 7));
    Eigen::Vector2d pixel = kCamera.project(point_m);
    for (int round = 0; round < 10; ++round)
      pixel = kCamera.project(
          exp_se3(-(kFrame_s + kTiming.color_time_s(pixel.y(), kCamera.height)) * twist_per_s) *
          point_m);
    motion.corners.push_back({point_m, pixel});
  }
  motion.corner_count = 60;
  motion.earlier_from_frame =
      track::motion_by_corners(motion.corners, motion.corners, 60, motion.camera)
          ->earlier_from_frame;
  return motion;
}

frame::PreparedFrame frame_at(double timestamp_s) {
  frame::RgbdFrame frame{timestamp_s, DepthImage(kCamera.width, kCamera.height),
                         ColorImage(kCamera.width, kCamera.height)};
  for (int y = 0; y < kCamera.height; ++y)
    for (int x = 0; x < kCamera.width; ++x) {
      frame.depth.at(x, y) = static_cast<std::uint16_t>(8000 + 5 * x + 9 * y);
      frame.color.at(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y),
                              static_cast<std::uint8_t>(x + y)};
    }
  return FramePreparer(kCamera, Options{}, 0).prepare(std::move(frame));
}

int farthest(const DepthImage& a, const DepthImage& b) {
  int most = 0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i)
    if (a.pixels[i] != 0 && b.pixels[i] != 0)
      most = std::max(most, std::abs(int{a.pixels[i]} - int{b.pixels[i]}));
  return most;
}

class RollingShutterTest : public test::GpuTest {
 protected:
  RollingShutter shutter_{device(), kCamera, frame::FrameOptions{}};
  const Vector6d twist_per_s_ = (Vector6d() << 0.4, -0.2, 0.3, 0.5, -0.6, 0.3).finished();
  frame::Retimer retimer_{device(), kCamera};
};

TEST_F(RollingShutterTest, TheVelocityOfASteadyCameraComesFromTheCornersAlone) {
  const frame::PreparedFrame frame = frame_at(1 + kFrame_s);
  shutter_.step(1, std::nullopt, true);
  const auto corrected = shutter_.corrected(frame, corners_of(twist_per_s_));
  ASSERT_TRUE(corrected);
  EXPECT_LE(farthest(corrected->frame.frame.depth, retimer_.apply(frame.frame, twist_per_s_).depth),
            2);
  EXPECT_GT(farthest(frame.frame.depth, corrected->frame.frame.depth), 20);
  EXPECT_EQ(corrected->frame.content.depth_digest, frame.content.depth_digest)
      << "that of the frame as recorded";
}

TEST_F(RollingShutterTest, BetweenTwoFramesAsTheyWereTakenCornersTellTheVelocityAtOnce) {
  const frame::PreparedFrame frame = frame_at(1 + kFrame_s);
  shutter_.step(1, std::nullopt, false);
  track::FeatureMotion motion = corners_of(twist_per_s_);
  motion.earlier_from_frame = exp_se3(kFrame_s * twist_per_s_);
  const auto corrected = shutter_.corrected(frame, motion);
  ASSERT_TRUE(corrected);
  EXPECT_EQ(corrected->frame.frame.depth,
            retimer_.apply(frame.frame, log_se3(motion.earlier_from_frame) / kFrame_s).depth);
}

TEST_F(RollingShutterTest, WithoutCornersItIsTheLastOne) {
  const frame::PreparedFrame frame = frame_at(1 + kFrame_s);
  shutter_.step(1 - kFrame_s, std::nullopt, true);
  shutter_.step(1, exp_se3(kFrame_s * twist_per_s_), true);
  const auto corrected = shutter_.corrected(frame, std::nullopt);
  ASSERT_TRUE(corrected);
  EXPECT_EQ(
      corrected->frame.frame.depth,
      retimer_.apply(frame.frame, log_se3(exp_se3(kFrame_s * twist_per_s_)) / kFrame_s).depth);
}

TEST_F(RollingShutterTest, AFrameWhoseVelocityIsUnknownStaysAsItIs) {
  EXPECT_FALSE(shutter_.corrected(frame_at(1), std::nullopt)) << "the first one";
  shutter_.step(1, std::nullopt, true);
  EXPECT_FALSE(shutter_.corrected(frame_at(1 + kFrame_s), std::nullopt)) << "no motion is known";
  EXPECT_FALSE(shutter_.corrected(frame_at(1.5), corners_of(twist_per_s_))) << "after a gap";
  EXPECT_FALSE(shutter_.corrected(frame_at(0.9), corners_of(twist_per_s_)))
      << "a clock that goes back";
}

TEST_F(RollingShutterTest, IsCorrectedAgainWhereTrackingFindsAnotherMotion) {
  const frame::PreparedFrame frame = frame_at(1 + kFrame_s);
  shutter_.step(1, std::nullopt, true);
  const auto corrected = shutter_.corrected(frame, corners_of(twist_per_s_));
  ASSERT_TRUE(corrected);
  EXPECT_FALSE(shutter_.corrected_again(frame, *corrected, corrected->last_from_camera));
  const Rigid3 nearly =
      corrected->last_from_camera * Rigid3{Eigen::Quaterniond::Identity(), {0.0005, 0, 0}};
  EXPECT_FALSE(shutter_.corrected_again(frame, *corrected, nearly))
      << "which moves the first row by a fifth of a millimetre";
  const Rigid3 found =
      corrected->last_from_camera * Rigid3{Eigen::Quaterniond::Identity(), {0, 0, 0.01}};
  const auto again = shutter_.corrected_again(frame, *corrected, found);
  ASSERT_TRUE(again);
  EXPECT_EQ(again->frame.frame.depth, retimer_.apply(frame.frame, log_se3(found) / kFrame_s).depth);
  EXPECT_EQ(again->frame.content.depth_digest, frame.content.depth_digest);
  EXPECT_EQ(again->last_from_camera.translation, found.translation);
}

TEST_F(RollingShutterTest, GoesOnFromASavedState) {
  shutter_.step(1 - kFrame_s, std::nullopt, true);
  shutter_.step(1, exp_se3(kFrame_s * twist_per_s_), true);
  ByteWriter saved;
  shutter_.save(saved);
  const std::string bytes = saved.take();
  RollingShutter restored(device(), kCamera, frame::FrameOptions{});
  ByteReader reader(bytes);
  restored.restore(reader);
  ASSERT_TRUE(reader.ok() && reader.at_end());
  const frame::PreparedFrame frame = frame_at(1 + kFrame_s);
  EXPECT_EQ(restored.corrected(frame, std::nullopt)->frame.frame.depth,
            shutter_.corrected(frame, std::nullopt)->frame.frame.depth);
}

// Small images, in which corners tell the velocity worst.
const std::string kWalk = "synthetic:speed=1.5,frames=30,width=160,height=120";

const test::Recording& rolling() {
  static const test::Recording made = [] {
    test::Recording recording = test::record(kWalk + "+rolling=ms=30");
    recording.camera.timing = {0.030, 0.030, 0};
    return recording;
  }();
  return made;
}

double error_m(const Pipeline& pipeline) {
  return evaluate::trajectory_error(pipeline.trajectory(), rolling().groundtruth)->ate_m.rmse;
}

// A scan by a camera that says when its rows are taken is nearly as good as one without a rolling
// shutter.
TEST(RollingShutterScan, IsMoreAccurateWithTheTimingKnown) {
  const test::Recording clean = test::record(kWalk);
  const auto scan_error_m = [](const Camera& camera, const std::vector<frame::RgbdFrame>& frames) {
    Pipeline pipeline("", camera, Options{});
    for (const frame::RgbdFrame& frame : frames) EXPECT_TRUE(pipeline.process(frame).ok());
    return error_m(pipeline);
  };
  const double clean_m = scan_error_m(clean.camera, clean.frames),
               as_taken_m = scan_error_m(clean.camera, rolling().frames),
               corrected_m = scan_error_m(rolling().camera, rolling().frames);
  RecordProperty("clean_mm", std::to_string(1e3 * clean_m));
  RecordProperty("as_taken_mm", std::to_string(1e3 * as_taken_m));
  RecordProperty("corrected_mm", std::to_string(1e3 * corrected_m));
  EXPECT_LT(corrected_m - clean_m, 0.5 * (as_taken_m - clean_m));
}

TEST(RollingShutterScan, BeginsItsMapWithTheSecondFrameAlsoFromACheckpointBetween) {
  Pipeline whole("", rolling().camera, Options{});
  const FrameResult first = *whole.process(rolling().frames[0]);
  EXPECT_EQ(first.status, track::TrackingStatus::kWeak);
  EXPECT_THAT(first.reason, testing::HasSubstr("rolling shutter"));
  EXPECT_EQ(first.surfel_count, 0);
  Pipeline second("", rolling().camera, Options{});
  const Status restored = second.restore(*whole.save());
  ASSERT_TRUE(restored.ok()) << restored.error().message;
  for (std::size_t i = 1; i < 8; ++i) {
    EXPECT_EQ(whole.process(rolling().frames[i])->status, track::TrackingStatus::kTracked) << i;
    ASSERT_TRUE(second.process(rolling().frames[i]).ok());
  }
  EXPECT_GT(whole.statistics().surfel_count, 0);
  EXPECT_EQ(second.trajectory().back().world_from_camera.translation,
            whole.trajectory().back().world_from_camera.translation);
  EXPECT_LT(error_m(whole), 0.005);
}

}  // namespace
}  // namespace hermite::pipeline::rolling_shutter_test
