#include "core/calibrate/calibrate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/calibrate/camera_watch.h"
#include "core/dataset/changed_sequence.h"
#include "core/source/open_sequence.h"

namespace hermite::calibrate {
namespace {

using testing::HasSubstr;

// Four seconds of a hand in the room, 36 views.
constexpr const char* kRoom = "synthetic:frames=120,width=320,height=240";
constexpr dataset::FrameRange kAll{0, 120};
// The time of rows matters in fast movements.
constexpr const char* kFastRoom = "synthetic:speed=2,frames=60,width=320,height=240";

std::unique_ptr<dataset::Sequence> open(const std::string& source) {
  Result<std::unique_ptr<dataset::Sequence>> sequence = source::open_sequence(source);
  EXPECT_TRUE(sequence.ok()) << sequence.error().message;
  return *std::move(sequence);
}

// The true poses, led astray as a tracker is by a wrong camera: 5 cm and 2 degrees by the end.
dataset::Trajectory drifting(dataset::Trajectory poses) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(poses.size());
    poses[i].world_from_camera =
        poses[i].world_from_camera *
        exp_se3((Vector6d() << 0.03, -0.02, 0.035, 0.01, 0.03, -0.01).finished() * share);
  }
  return poses;
}

Calibration calibrated(const dataset::Sequence& sequence) {
  CalibrateOptions options;
  options.max_view_count = 16;
  options.thread_count = 2;
  return calibrate(sequence, {0, sequence.frame_count()}, drifting(sequence.groundtruth()),
                   options);
}

// Calibrates at the true poses, since a tracker's errors from frame to frame are small beside the
// camera's velocity.
Calibration timed(const dataset::Sequence& sequence) {
  CalibrateOptions options;
  options.max_view_count = 16;
  options.thread_count = 2;
  return calibrate(sequence, {0, sequence.frame_count()}, sequence.groundtruth(), options);
}

// Only these numbers are applied, and those that were found to be off with it by chance are not.
void expect_alone(const Calibration& found, const std::vector<CameraNumber>& numbers, double value,
                  double tolerance) {
  ASSERT_EQ(found.numbers.size(), kCameraNumberCount) << found.reason;
  EXPECT_TRUE(found.is_applied) << found.reason;
  for (std::size_t k = 0; k < kCameraNumberCount; ++k)
    EXPECT_EQ(found.numbers[k].is_applied, std::ranges::find(numbers, k) != numbers.end())
        << found.numbers[k].name << ' ' << found.numbers[k].value << " +- "
        << found.numbers[k].deviation << ' ' << found.numbers[k].reason;
  for (const CameraNumber number : numbers) {
    EXPECT_NEAR(found.numbers[number].value, value, tolerance);
    EXPECT_GT(found.numbers[number].deviation, 0);
    EXPECT_LT(found.numbers[number].deviation, tolerance);
  }
  // The timing of colour moves no surface.
  if (numbers.front() < kColorReadout) {
    EXPECT_LT(found.after.rms_m, found.before.rms_m);
  }
}

// Without what may still be wrong with them.
Camera numbers_of(Camera camera) {
  camera.deviations = {};
  return camera;
}

TEST(Calibrate, FindsABend) {
  const auto sequence = open(std::string(kRoom) + "+bend=percent=2+noise=kinect-white,seed=1");
  const Calibration found = calibrated(*sequence);
  expect_alone(found, {kBend}, 1 / 1.02 - 1, 0.002);  // a tenth
  EXPECT_EQ(found.camera.depth_correction.bend, found.numbers[kBend].value);
  EXPECT_EQ(found.camera.fx, sequence->camera().fx);
  // What may still be wrong: not less than in a camera that fits, and less than in an unknown one.
  EXPECT_GE(found.camera.deviations.bend, kFitting.bend);
  EXPECT_LT(found.camera.deviations.bend, 0.004);
  EXPECT_GE(found.camera.deviations.focal, kFitting.focal);
  EXPECT_LT(found.camera.deviations.focal, 0.004);
}

TEST(Calibrate, FindsAFocalLength) {
  const auto sequence = open(std::string(kRoom) + "+focal=percent=-2+noise=kinect-white,seed=2");
  const Calibration found = calibrated(*sequence);
  expect_alone(found, {kFocal}, 1 / 0.98 - 1, 0.002);
  EXPECT_NEAR(found.camera.fx, 262.5, 0.6);
  EXPECT_NEAR(found.camera.fy / found.camera.fx, sequence->camera().fy / sequence->camera().fx,
              1e-12);
  EXPECT_EQ(found.camera.depth_correction, DepthCorrection{});
}

TEST(Calibrate, FindsALensThatDistorts) {
  const auto sequence = open(std::string(kRoom) + "+lens=k1=-0.04+noise=kinect-white,seed=2");
  const Calibration found = calibrated(*sequence);
  expect_alone(found, {kRadial}, -0.04, 0.004);
  EXPECT_EQ(found.camera.distortion.k1, found.numbers[kRadial].value);
}

// The depth that a sensor measures whose correction has that offset.
class OffsetSequence : public dataset::ChangedSequence {
 public:
  OffsetSequence(std::unique_ptr<dataset::Sequence> original, double offset_per_m)
      : dataset::ChangedSequence(std::move(original)), offset_per_m_(offset_per_m) {}
  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    Result<dataset::RecordedFrame> frame = original_->read(index);
    if (!frame.ok()) return frame;
    for (std::uint16_t& pixel : frame->depth.pixels) {
      const double depth_m = pixel / camera().depth_units_per_metre;
      pixel = static_cast<std::uint16_t>(
          std::lround(pixel / (1 + offset_per_m_ * (kUndistortedDepth_m - depth_m))));
    }
    return frame;
  }

 private:
  const double offset_per_m_;
};

TEST(Calibrate, FindsAnOffsetOfTheInverseDepth) {
  const OffsetSequence sequence(open(kRoom), 0.02);
  expect_alone(calibrated(sequence), {kInverseOffset}, 0.02, 0.003);
}

TEST(Calibrate, FindsARollingShutter) {
  const auto sequence = open(std::string(kFastRoom) + "+rolling=ms=30+noise=kinect-white,seed=4");
  const Calibration found = timed(*sequence);
  expect_alone(found, {kDepthReadout, kColorReadout}, 0.030, 0.006);  // a fifth
  EXPECT_EQ(rectified(numbers_of(found.camera)), rectified(sequence->camera()));
  EXPECT_EQ(found.camera.timing.depth_readout_s, found.numbers[kDepthReadout].value);
  EXPECT_EQ(found.camera.timing.color_readout_s, found.numbers[kColorReadout].value);
  EXPECT_EQ(found.camera.timing.color_delay_s, 0);
}

TEST(Calibrate, FindsTheDelayOfColour) {
  const auto sequence = open(std::string(kFastRoom) + "+clock=ms=-20+noise=kinect-white,seed=5");
  const Calibration found = timed(*sequence);
  expect_alone(found, {kColorDelay}, -0.020, 0.004);
  EXPECT_EQ(found.camera.timing, (ImageTiming{0, 0, found.numbers[kColorDelay].value}));
}

TEST(Calibrate, SaysThatPosesTooFarApartTellNothingOfTheTiming) {
  const auto sequence = open("synthetic:frames=15,rate=5,width=320,height=240+rolling=ms=30");
  const Calibration found = timed(*sequence);
  ASSERT_EQ(found.numbers.size(), kCameraNumberCount) << found.reason;
  EXPECT_THAT(found.numbers[kDepthReadout].reason, HasSubstr("too far apart in time"));
  EXPECT_EQ(found.camera.timing, ImageTiming{});
}

TEST(Calibrate, LeavesARightCameraAsItIs) {
  const auto sequence = open(std::string(kRoom) + "+noise=kinect-white,seed=3");
  const Calibration found = calibrated(*sequence);
  EXPECT_FALSE(found.is_applied);
  EXPECT_EQ(numbers_of(found.camera), sequence->camera());
  EXPECT_THAT(found.reason, HasSubstr("no parameter"));
  EXPECT_EQ(found.after.rms_m, found.before.rms_m);
  for (const FoundNumber& number : found.numbers) EXPECT_NE(number.reason, "") << number.name;
}

TEST(Calibrate, GoesOnFromWhatIsCorrectedAlready) {
  const auto bent = open(std::string(kRoom) + "+bend=percent=2+noise=kinect-white,seed=1");
  Camera camera = bent->camera();
  camera.depth_correction.bend = 1 / 1.02 - 1;
  const dataset::RecalibratedSequence right(
      open(std::string(kRoom) + "+bend=percent=2+noise=kinect-white,seed=1"), camera);
  const Calibration found = calibrated(right);
  EXPECT_FALSE(found.is_applied);
  EXPECT_EQ(numbers_of(found.camera), camera);
}

TEST(Calibrate, IsTheSameWhateverTheNumberOfThreads) {
  const auto sequence = open(std::string(kRoom) + "+bend+focal+noise=kinect-white,seed=1");
  const auto with_threads = [&](unsigned count) {
    CalibrateOptions options;
    options.thread_count = count;
    return format_calibration_json(
        calibrate(*sequence, {0, 40}, drifting(sequence->groundtruth()), options));
  };
  EXPECT_EQ(with_threads(1), with_threads(3));
}

TEST(Calibrate, SaysThatACameraThatStandsStillTellsNothing) {
  const auto sequence = open(kRoom);
  const Calibration found = calibrate(*sequence, {0, 10}, sequence->groundtruth());
  EXPECT_FALSE(found.is_applied);
  EXPECT_THAT(found.reason, HasSubstr("too few overlapping views"));
  EXPECT_TRUE(calibrate(*sequence, kAll, {}).numbers.empty()) << "no frame was tracked";
}

// A slanted wall as a camera with that correction measures it.
TEST(Facets, OfCorrectedDepthLieInTheTruePlane) {
  Camera camera{320, 240, 262.5, 262.5, 159.5, 119.5, 20000};
  camera.depth_correction = {-0.02, 0.03};
  const Eigen::Vector3d plane(0.1, -0.15, 0.6);  // 1/m
  DepthImage depth(camera.width, camera.height);
  const auto [bend, offset] = camera.depth_correction;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const double true_m = 1 / plane.dot(camera.unproject(x, y, 1));
      const double bent_m = true_m / (1 + offset * (kUndistortedDepth_m - true_m));
      depth.at(x, y) = static_cast<std::uint16_t>(
          std::lround(bent_m / (1 + bend * camera.rho2(x, y)) * camera.depth_units_per_metre));
    }
  int count = 0;
  for (const Facet& facet : facets_of(patches_of(depth, camera), camera)) {
    if (facet.point_m.z() <= 0) continue;
    ++count;
    EXPECT_NEAR(plane.dot(facet.point_m.cast<double>()), 1, 1e-4);
    EXPECT_LT((facet.plane_per_m.cast<double>().normalized() - plane.normalized()).norm(), 3e-3);
  }
  EXPECT_GT(count, 15000);
}

}  // namespace
}  // namespace hermite::calibrate
