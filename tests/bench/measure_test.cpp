#include "tests/bench/program/measure.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/temporary_folder.h"

namespace hermite::bench {
namespace {

TEST(FrameToPlay, GoesForwardAndBackWithoutAJump) {
  std::vector<std::int64_t> played;
  for (std::int64_t step = 0; step < 9; ++step) played.push_back(frame_to_play(step, 4));
  EXPECT_EQ(played, (std::vector<std::int64_t>{0, 1, 2, 3, 2, 1, 0, 1, 2}));
  EXPECT_EQ(frame_to_play(7, 1), 0);
  EXPECT_EQ(frame_to_play(3, 2), 1);
}

TEST(MeasuredFrameCount, IsAllOfTheFileOrEnoughForPercentiles) {
  Arguments arguments;
  arguments.warm_up_count = 10;
  EXPECT_EQ(measured_frame_count(arguments, 1000), 990);
  EXPECT_EQ(measured_frame_count(arguments, 30), kFewestFrames);
  arguments.frame_count = 5;
  EXPECT_EQ(measured_frame_count(arguments, 1000), 5) << "who asks for few gets few";
}

TEST(Percentile, IsTheValueOfNearestRank) {
  const std::vector<double> values{5, 1, 4, 2, 3};
  EXPECT_EQ(percentile(values, 0), 1);
  EXPECT_EQ(percentile(values, 0.5), 3);
  EXPECT_EQ(percentile(values, 0.8), 4);
  EXPECT_EQ(percentile(values, 0.95), 5);
  EXPECT_EQ(percentile(values, 1), 5);
  EXPECT_EQ(percentile({1, 2}, 0.5), 1);
  EXPECT_EQ(percentile({}, 0.5), 0);
}

// A wall one and a half metres away, with waves to track by.
frame::RgbdFrame wall(const Camera& camera, int number) {
  frame::RgbdFrame frame{0.1 * number, DepthImage(camera.width, camera.height),
                         ColorImage(camera.width, camera.height)};
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      frame.depth.at(x, y) = static_cast<std::uint16_t>(1500 + number + 60 * std::sin(0.15 * x) +
                                                        60 * std::cos(0.2 * y));
      frame.color.at(x, y) = {static_cast<std::uint8_t>(5 * x), static_cast<std::uint8_t>(3 * y),
                              90};
    }
  return frame;
}

TEST(Measure, KeepsEveryFrameBehindTheWarmUp) {
  const test::TemporaryFolder folder;
  const Camera camera{96, 72, 90, 90, 47.5, 35.5, 1000};
  Result<RawFrameWriter> writer = RawFrameWriter::create(folder / "wall.raw", camera, 3);
  ASSERT_TRUE(writer.ok());
  for (int i = 0; i < 3; ++i) ASSERT_TRUE(writer->append(wall(camera, i)).ok());
  ASSERT_TRUE(writer->finish().ok());
  Result<RawFrameReader> file = RawFrameReader::open(folder / "wall.raw");
  ASSERT_TRUE(file.ok()) << file.error().message;
  Arguments arguments;
  arguments.warm_up_count = 1;
  arguments.frame_count = 4;

  const Measurement measurement = measure(*file, arguments);
  EXPECT_EQ(measurement.statistics.frame_count, 5);
  ASSERT_EQ(measurement.frames.size(), 4u);
  const std::int64_t expected_index[] = {1, 2, 1, 0};
  for (std::size_t i = 0; i < 4; ++i) {
    const MeasuredFrame& frame = measurement.frames[i];
    EXPECT_EQ(frame.index, expected_index[i]);
    EXPECT_TRUE(frame.tracked);
    ASSERT_EQ(frame.timeline.stages.size(), 4u);
    EXPECT_GT(frame.timeline.passes.size(), 15u);
    double stages_ms = 0, passes_ms = 0;
    for (const Timeline::Stage& stage : frame.timeline.stages) stages_ms += stage.duration_ms;
    for (const Timeline::Pass& pass : frame.timeline.passes) passes_ms += pass.duration_ms;
    EXPECT_LE(stages_ms, frame.wall_ms);
    EXPECT_LE(passes_ms, stages_ms);
    EXPECT_GE(frame.timeline.stages.front().start, frame.start);
  }
}

}  // namespace
}  // namespace hermite::bench
