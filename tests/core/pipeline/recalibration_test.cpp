// A camera that turns out to be off while the scan goes on.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <memory>
#include <string>

#include "core/evaluate/trajectory_error.h"
#include "core/output/ply.h"
#include "core/pipeline/pipeline.h"
#include "tests/support/recording.h"

namespace hermite::pipeline::recalibration_test {
namespace {

using testing::HasSubstr;
using testing::MatchesRegex;

// Six seconds of a hand. The camera says a focal length that is 2 % too great.
const test::Recording& recording() {
  static const test::Recording made =
      test::record("synthetic:scene=bare,frames=60,width=160,height=120,rate=10+focal=percent=2");
  return made;
}
constexpr std::size_t kUnread = 7;

Options exporting_all() {
  Options options;
  options.output_unstable = true;
  return options;
}

// What the pipeline gets when it asks for its frames again.
enum class Past { kNone, kAll, kAllButOne };

BackEnd back_end(Past past) {
  BackEnd parts;
  parts.camera_watch = calibrate::make_camera_watch;
  const auto frame = [past](std::int64_t index, double) -> Result<frame::RgbdFrame> {
    if (past == Past::kAllButOne && index == kUnread)
      return Error{ErrorCode::kIo, "the disk says no"};
    return recording().frames[static_cast<std::size_t>(index)];
  };
  if (past != Past::kNone) parts.past_frames = [frame] { return frame; };
  return parts;
}

std::unique_ptr<Pipeline> make_pipeline(Past past = Past::kAll) {
  return std::make_unique<Pipeline>("", recording().camera, exporting_all(), back_end(past));
}

std::string poses_of(const Pipeline& pipeline) {
  std::string bytes;
  for (const dataset::TimedPose& pose : pipeline.trajectory()) {
    bytes.append(reinterpret_cast<const char*>(pose.world_from_camera.rotation.coeffs().data()),
                 4 * sizeof(double));
    bytes.append(reinterpret_cast<const char*>(pose.world_from_camera.translation.data()),
                 3 * sizeof(double));
  }
  return bytes;
}

struct Ended {
  std::string poses, cloud;
};

Ended ended(Pipeline& pipeline) {
  pipeline.finish();
  return {poses_of(pipeline), output::format_ply(*pipeline.cloud())};
}

// All frames of the recording, with what was told of them.
struct Scanned {
  std::unique_ptr<Pipeline> pipeline;
  std::vector<FrameResult> results;
  // The slots that are alive, as viewers have them.
  std::map<std::uint32_t, output::CloudPoint> mirror;
};

Scanned scan(std::unique_ptr<Pipeline> pipeline) {
  Scanned scanned{std::move(pipeline), {}, {}};
  const auto mirror = [&scanned] {
    const std::vector<output::SlotChange> changes = *scanned.pipeline->take_changes();
    for (const output::SlotChange& change : changes) {
      scanned.mirror.erase(change.slot);
      if (change.alive) scanned.mirror[change.slot] = change.point;
    }
  };
  for (const frame::RgbdFrame& frame : recording().frames) {
    scanned.results.push_back(*scanned.pipeline->process(frame));
    if (scanned.results.size() % 10 == 5) mirror();
  }
  scanned.pipeline->finish();
  mirror();
  return scanned;
}

std::size_t event_count(const std::vector<FrameResult>& results, MapEvent event) {
  return static_cast<std::size_t>(std::count_if(
      results.begin(), results.end(), [event](const FrameResult& r) { return r.event == event; }));
}

// Made once: each test needs it to compare with.
const Scanned& corrected_scan() {
  static const Scanned scanned = scan(make_pipeline());
  return scanned;
}

TEST(Recalibration, MakesTheScanAnewAsWithTheRightCamera) {
  const Scanned& scanned = corrected_scan();
  ASSERT_EQ(event_count(scanned.results, MapEvent::kRecalibrated), 1u);
  const PipelineStatistics statistics = scanned.pipeline->statistics();
  ASSERT_TRUE(statistics.corrected_camera);
  EXPECT_EQ(statistics.calibration_doubt, "");
  EXPECT_THAT(
      statistics.camera_correction,
      MatchesRegex(
          "the camera's calibration was off and is corrected: focal length by -[12]\\.[0-9]+ %"));
  EXPECT_NEAR(statistics.corrected_camera->fx / recording().camera.fx, 1 / 1.02, 0.003);
  EXPECT_EQ(statistics.frame_count, static_cast<std::int64_t>(recording().frames.size()));
  EXPECT_EQ(scanned.mirror.size(), scanned.pipeline->cloud()->size());
  const auto error =
      evaluate::trajectory_error(scanned.pipeline->trajectory(), recording().groundtruth);
  EXPECT_LT(error->ate_m.rmse, 0.006);

  Pipeline right("", *statistics.corrected_camera, exporting_all());
  for (const frame::RgbdFrame& frame : recording().frames) ASSERT_TRUE(right.process(frame).ok());
  const Ended expected = ended(right);
  EXPECT_TRUE(poses_of(*scanned.pipeline) == expected.poses);
  EXPECT_TRUE(output::format_ply(*scanned.pipeline->cloud()) == expected.cloud);
}

// The next scan of the same device begins with what this one found out.
TEST(Recalibration, WhatIsKnownOfTheCameraIsForItsNextScan) {
  const PipelineStatistics statistics = corrected_scan().pipeline->statistics();
  const Camera& known = statistics.known_camera;
  EXPECT_EQ(known.fx, statistics.corrected_camera->fx);
  EXPECT_LT(known.deviations.bend, 0.002);
  EXPECT_LT(known.deviations.focal, 0.002);
  Pipeline next("", known, exporting_all());
  double unknown_m = 0, known_m = 0;
  Pipeline as_if_unknown("", *statistics.corrected_camera, exporting_all());
  for (std::size_t i = 0; i < 20; ++i) {
    known_m = next.process(recording().frames[i])->uncertainty->position_sigma_m();
    unknown_m = as_if_unknown.process(recording().frames[i])->uncertainty->position_sigma_m();
  }
  EXPECT_GT(known_m, 0);
  EXPECT_LT(known_m, 0.8 * unknown_m);
  EXPECT_TRUE(poses_of(next) == poses_of(as_if_unknown)) << "only what is stated differs";
}

// A scan that is broken off and goes on from its checkpoint ends as one that was not.
TEST(Recalibration, GoesOnFromACheckpointWhileTheAnswerIsAwaitedAndAfterIt) {
  const Scanned& scanned = corrected_scan();
  std::unique_ptr<Pipeline> pipeline = make_pipeline();
  const std::vector<frame::RgbdFrame>& frames = recording().frames;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (i == 30 || i == 50) {
      EXPECT_EQ(pipeline->statistics().corrected_camera.has_value(), i == 50);
      const std::string state = *pipeline->save();
      pipeline = make_pipeline();
      const Status restored = pipeline->restore(state);
      ASSERT_TRUE(restored.ok()) << restored.error().message;
    }
    ASSERT_TRUE(pipeline->process(frames[i]).ok());
  }
  const Ended resumed = ended(*pipeline);
  EXPECT_TRUE(resumed.poses == poses_of(*scanned.pipeline));
  EXPECT_TRUE(resumed.cloud == output::format_ply(*scanned.pipeline->cloud()));
}

TEST(Recalibration, OfAScanWithoutItsFramesIsADoubtThatMakesFramesWeak) {
  const Scanned scanned = scan(make_pipeline(Past::kNone));
  EXPECT_EQ(event_count(scanned.results, MapEvent::kRecalibrated), 0u);
  EXPECT_FALSE(scanned.pipeline->statistics().corrected_camera);
  EXPECT_EQ(scanned.results.back().status, track::TrackingStatus::kWeak);
  EXPECT_THAT(
      scanned.results.back().reason,
      HasSubstr("the camera's calibration does not fit: its focal length is too great by about"));
}

TEST(Recalibration, TakesAFrameThatCannotBeReadAgainForAnEmptyOne) {
  const Scanned scanned = scan(make_pipeline(Past::kAllButOne));
  EXPECT_EQ(event_count(scanned.results, MapEvent::kRecalibrated), 1u);
  ASSERT_EQ(scanned.pipeline->trajectory().size(), recording().frames.size());
  const auto place = [&scanned](std::size_t frame) {
    return scanned.pipeline->trajectory()[frame].world_from_camera.translation;
  };
  EXPECT_LT((place(kUnread) - 0.5 * (place(kUnread - 1) + place(kUnread + 1))).norm(), 1e-6)
      << "between its neighbours";
  EXPECT_EQ(scanned.pipeline->statistics().tracked_frame_count,
            static_cast<std::int64_t>(recording().frames.size()) - 1);
}

TEST(Recalibration, TakesACameraAsItIsWhenItIsTold) {
  Options options = exporting_all();
  options.frame.correct_camera = false;
  const Scanned scanned =
      scan(std::make_unique<Pipeline>("", recording().camera, options, back_end(Past::kAll)));
  EXPECT_EQ(event_count(scanned.results, MapEvent::kRecalibrated), 0u);
  EXPECT_FALSE(scanned.pipeline->statistics().corrected_camera);
}

}  // namespace
}  // namespace hermite::pipeline::recalibration_test
