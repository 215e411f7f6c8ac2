// Nothing that a frame contains may end a scan or spoil its map. Frames 5 to 7 of a good recording
// are disturbed in every way we know of; afterwards the camera must be where it truly is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "core/pipeline/pipeline.h"
#include "tests/support/recording.h"

namespace hermite::pipeline::robustness_test {
namespace {

using testing::StartsWith;

constexpr std::size_t kFrameCount = 16, kFirstBad = 5, kEndOfBad = 8, kEndOfDisturbed = 11;

const test::Recording& recording() {
  static const test::Recording made =
      test::record("synthetic:frames=" + std::to_string(kFrameCount) + ",width=160,height=120");
  return made;
}

const test::Recording& other_room() {
  static const test::Recording made =
      test::record("synthetic:frames=3,width=160,height=120,scene=bare,seed=5");
  return made;
}

using Frames = std::vector<frame::RgbdFrame>;

void change_pixels(
    frame::RgbdFrame& frame,
    const std::function<void(int x, int y, std::uint16_t& depth, Rgb8& color)>& change) {
  for (int y = 0; y < frame.depth.height; ++y)
    for (int x = 0; x < frame.depth.width; ++x)
      change(x, y, frame.depth.at(x, y), frame.color.at(x, y));
}

struct Disturbance {
  const char* name;
  track::TrackingStatus expected;  // of the disturbed frames
  const char* reason;
  std::function<void(frame::RgbdFrame&, std::size_t)> change;
};

std::vector<Disturbance> disturbances() {
  const auto lost = track::TrackingStatus::kLost;
  const auto weak = track::TrackingStatus::kWeak;
  const auto metres = [](double m) {
    return static_cast<std::uint16_t>(m * recording().camera.depth_units_per_metre);
  };
  const auto pixels = [](auto change) {
    return [change](frame::RgbdFrame& frame, std::size_t) { change_pixels(frame, change); };
  };
  return {
      {"empty", lost, "too few points",
       pixels([](int, int, std::uint16_t& d, Rgb8& c) { d = 0, c = {}; })},
      {"too near to measure", lost, "too near",
       pixels([=](int x, int, std::uint16_t& d, Rgb8&) { d = x < 3 ? metres(0.45) : 0; })},
      {"nearer than the limit", lost, "too near",
       pixels([=](int, int, std::uint16_t& d, Rgb8&) { d = metres(0.2); })},
      {"white", weak, "dark or blurred", pixels([](int, int, std::uint16_t&, Rgb8& c) {
         c = {255, 255, 255};
       })},
      {"black", weak, "dark or blurred", pixels([](int, int, std::uint16_t&, Rgb8& c) { c = {}; })},
      {"a hand", lost, "occluded", pixels([=](int x, int y, std::uint16_t& d, Rgb8& c) {
         if (x > 30 && y > 20) d = metres(0.5), c = {200, 150, 120};
       })},
      {"another room", lost, "",
       [](frame::RgbdFrame& frame, std::size_t i) { frame = other_room().frames[i - kFirstBad]; }},
      {"another room's depth", lost, "",
       [](frame::RgbdFrame& frame, std::size_t i) {
         frame.depth = other_room().frames[i - kFirstBad].depth;
       }},
      {"upside down", lost, "",
       [](frame::RgbdFrame& frame, std::size_t) {
         std::reverse(frame.depth.pixels.begin(), frame.depth.pixels.end());
         std::reverse(frame.color.pixels.begin(), frame.color.pixels.end());
       }},
      {"wrong scale", lost, "", pixels([](int, int, std::uint16_t& d, Rgb8&) {
         d = static_cast<std::uint16_t>(d * 7 / 10);
       })},
  };
}

Rigid3 true_pose(std::size_t frame) {
  return inverse(recording().groundtruth[0].world_from_camera) *
         recording().groundtruth[frame].world_from_camera;
}

// Runs the recording with these frames; the statuses expected of disturbed ones are checked by the
// caller.
std::vector<FrameResult> run(const Frames& frames) {
  Pipeline pipeline("", recording().camera, Options{});
  std::vector<FrameResult> results;
  for (const frame::RgbdFrame& frame : frames) {
    const Result<FrameResult> result = pipeline.process(frame);
    EXPECT_TRUE(result.ok()) << result.error().message;
    results.push_back(*result);
  }
  return results;
}

// A pixel is 2 cm wide at this size where the room is 2.5 m away.
void expect_true_pose(const FrameResult& result, std::size_t frame) {
  EXPECT_NE(result.status, track::TrackingStatus::kLost) << frame << ": " << result.reason;
  EXPECT_LT((result.world_from_camera.translation - true_pose(frame).translation).norm(), 0.01)
      << frame;
}

TEST(Robustness, DisturbedFramesAreSaidToBeAndTheScanGoesOn) {
  for (const Disturbance& disturbance : disturbances()) {
    SCOPED_TRACE(disturbance.name);
    Frames frames(recording().frames.begin(), recording().frames.begin() + kEndOfDisturbed);
    for (std::size_t i = kFirstBad; i < kEndOfBad; ++i) disturbance.change(frames[i], i);
    const std::vector<FrameResult> results = run(frames);
    EXPECT_EQ(results[kFirstBad].status, disturbance.expected);
    for (std::size_t i = kFirstBad; i < kEndOfBad; ++i) {
      if (disturbance.expected != track::TrackingStatus::kLost) expect_true_pose(results[i], i);
      if (disturbance.expected != track::TrackingStatus::kLost) continue;
      EXPECT_EQ(results[i].status, track::TrackingStatus::kLost);
      EXPECT_THAT(results[i].reason, StartsWith(disturbance.reason)) << i;
      EXPECT_EQ(results[i].world_from_camera.translation,
                results[kFirstBad - 1].world_from_camera.translation)
          << "the pose is held";
      EXPECT_EQ(results[i].surfel_count, results[kFirstBad - 1].surfel_count) << "nothing is fused";
    }
    for (std::size_t i = kEndOfBad; i < kEndOfDisturbed; ++i) expect_true_pose(results[i], i);
  }
}

TEST(Robustness, HalfOfTheDepthIsEnough) {
  for (const bool lower : {false, true}) {
    Frames frames = recording().frames;
    for (std::size_t i = kFirstBad; i < kEndOfBad; ++i)
      change_pixels(frames[i], [lower](int, int y, std::uint16_t& d, Rgb8&) {
        d = (y < 60) == lower ? d : std::uint16_t{0};
      });
    const std::vector<FrameResult> results = run(frames);
    for (std::size_t i = 0; i < kFrameCount; ++i) expect_true_pose(results[i], i);
  }
}

TEST(Robustness, ARepeatedFrameIsAStillCamera) {
  Frames frames = recording().frames;
  for (std::size_t i = kFirstBad; i < kEndOfBad; ++i) frames[i] = frames[kFirstBad - 1];
  const std::vector<FrameResult> results = run(frames);
  for (std::size_t i = kFirstBad; i < kEndOfBad; ++i) expect_true_pose(results[i], kFirstBad - 1);
  for (std::size_t i = kEndOfBad; i < kFrameCount; ++i) expect_true_pose(results[i], i);
}

// Whichever frame comes, it is tracked where it belongs or lost, and never taken for another place.
TEST(Robustness, ShuffledFramesAreFoundWhereTheyBelongOrLost) {
  const std::size_t order[] = {0, 1, 2, 3, 12, 4, 15, 2, 6, 9, 5, 14, 7, 8};
  Frames frames;
  for (const std::size_t i : order) frames.push_back(recording().frames[i]);
  const std::vector<FrameResult> results = run(frames);
  std::size_t tracked_count = 0;
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (results[k].status == track::TrackingStatus::kLost) continue;
    ++tracked_count;
    expect_true_pose(results[k], order[k]);
  }
  EXPECT_GE(tracked_count, 10u);
}

// A dozen frames missing: 20 cm and 16 degrees at once.
TEST(Robustness, AGapIsBridged) {
  const test::Recording fast = test::record("synthetic:frames=24,width=160,height=120");
  Frames frames(fast.frames.begin(), fast.frames.begin() + 6);
  frames.insert(frames.end(), fast.frames.begin() + 18, fast.frames.end());
  const std::vector<FrameResult> results = run(frames);
  const Rigid3 expected =
      inverse(fast.groundtruth[0].world_from_camera) * fast.groundtruth[23].world_from_camera;
  EXPECT_NE(results.back().status, track::TrackingStatus::kLost) << results.back().reason;
  EXPECT_LT((results.back().world_from_camera.translation - expected.translation).norm(), 0.01);
}

}  // namespace
}  // namespace hermite::pipeline::robustness_test
