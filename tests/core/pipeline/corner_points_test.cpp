#include "core/track/corner_points.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/recording.h"

namespace hermite::pipeline::corner_points_test {
namespace {

const auto kNothingMoves = [](const Eigen::Vector2d&) { return false; };

struct Walk {
  explicit Walk(const std::string& source = "synthetic:frames=16,width=320,height=240,rate=15")
      : recording(test::record(source)) {}
  frame::ImageFeatures features(std::size_t frame) const {
    return frame::features_of(recording.frames[frame], recording.camera.depth_units_per_metre, {});
  }
  Rigid3 pose(std::size_t frame) const { return recording.groundtruth[frame].world_from_camera; }
  track::CornerPoints points() const { return {recording.camera, {}}; }
  // Follows frame `frame` at its true pose.
  void show(track::CornerPoints& points, std::size_t frame) const {
    const frame::ImageFeatures seen = features(frame);
    if (frame > 0) points.follow(features(frame - 1), seen, kNothingMoves);
    const Rigid3 step = frame == 0 ? Rigid3{} : inverse(pose(frame - 1)) * pose(frame);
    points.remember(seen, recording.frames[frame].depth, step, kNothingMoves);
  }
  void without_depth(std::size_t from) {
    for (std::size_t frame = from; frame < recording.frames.size(); ++frame)
      recording.frames[frame].depth = DepthImage(320, 240);
  }
  test::Recording recording;
};

std::size_t known_count(const track::CornerPoints& points) {
  std::size_t count = 0;
  for (const track::CornerPoint& point : points.all()) count += point.depth_deviation_m > 0 ? 1 : 0;
  return count;
}

std::string saved(const track::CornerPoints& points) {
  ByteWriter writer;
  points.save(writer);
  return writer.take();
}

// By their steps alone, each from the frame before: what holds them is the room.
TEST(CornerPoints, LeadThroughFramesWithoutDepth) {
  Walk walk;
  walk.without_depth(1);
  track::CornerPoints points = walk.points();
  Rigid3 pose = walk.pose(0);
  for (std::size_t frame = 0; frame < 10; ++frame) {
    const frame::ImageFeatures seen = walk.features(frame);
    const auto motion = points.follow(frame > 0 ? walk.features(frame - 1) : frame::ImageFeatures{},
                                      seen, kNothingMoves);
    ASSERT_EQ(motion.has_value(), frame > 0) << frame;
    const Rigid3 step = motion ? motion->earlier_from_frame : Rigid3{};
    EXPECT_FALSE(motion && motion->is_turn_only) << frame;
    pose = pose * step;
    points.remember(seen, walk.recording.frames[frame].depth, step, kNothingMoves);
  }
  const Vector6d error = log_se3(inverse(walk.pose(9)) * pose);
  EXPECT_LT(error.head<3>().norm(), 0.03);
  EXPECT_LT(error.tail<3>().norm(), 0.01);
}

TEST(CornerPoints, GetTheirDepthFromTwoDirections) {
  Walk walk;
  const std::vector<frame::RgbdFrame> truth = walk.recording.frames;
  walk.without_depth(0);
  track::CornerPoints points = walk.points();
  for (std::size_t frame = 0; frame < 12; ++frame) walk.show(points, frame);
  ASSERT_GT(known_count(points), 20u);
  int off = 0;
  for (const track::CornerPoint& point : points.all()) {
    if (point.depth_deviation_m == 0) continue;
    const int x = static_cast<int>(std::lround(point.pixel.x())),
              y = static_cast<int>(std::lround(point.pixel.y()));
    const double true_m = truth[11].depth.at(x, y) / walk.recording.camera.depth_units_per_metre;
    off += std::abs(point.point_m.z() - true_m) > 3 * point.depth_deviation_m + 0.01 ? 1 : 0;
  }
  EXPECT_LT(off, 0.15 * static_cast<double>(known_count(points)));
}

TEST(CornerPoints, AreNotWhatMovesAndOneForEachCell) {
  const Walk walk;
  track::CornerPoints points = walk.points();
  const auto left_moves = [](const Eigen::Vector2d& pixel) { return pixel.x() < 160; };
  points.remember(walk.features(0), walk.recording.frames[0].depth, {}, left_moves);
  ASSERT_GT(points.all().size(), 20u);
  for (const track::CornerPoint& point : points.all()) EXPECT_GE(point.pixel.x(), 160);
  for (std::size_t frame = 1; frame < 6; ++frame) walk.show(points, frame);
  EXPECT_LE(points.all().size(), 20u * 15u);
}

TEST(CornerPoints, AreForgotten) {
  const Walk walk;
  track::CornerPoints points = walk.points();
  walk.show(points, 0);
  EXPECT_TRUE(points.follow(walk.features(0), walk.features(1), kNothingMoves));
  points.forget();
  EXPECT_FALSE(points.follow(walk.features(0), walk.features(1), kNothingMoves));
}

TEST(CornerPoints, ComeBackFromBytesAndGoOnAlike) {
  const Walk walk;
  track::CornerPoints points = walk.points(), restored = walk.points();
  for (std::size_t frame = 0; frame < 4; ++frame) walk.show(points, frame);
  const std::string bytes = saved(points);
  ByteReader reader(bytes);
  restored.restore(reader, walk.features(3));
  ASSERT_TRUE(reader.ok() && reader.at_end());
  walk.show(points, 4);
  walk.show(restored, 4);
  EXPECT_EQ(saved(points), saved(restored));
}

TEST(CornerPoints, DamagedOnesAreRefused) {
  const Walk walk;
  track::CornerPoints points = walk.points();
  walk.show(points, 0);
  const std::string bytes = saved(points);
  for (const std::size_t length : {bytes.size() / 2, bytes.size() - 1}) {
    ByteReader reader(std::string_view(bytes).substr(0, length));
    track::CornerPoints restored = walk.points();
    restored.restore(reader, walk.features(0));
    EXPECT_FALSE(reader.ok());
  }
  // A patch of another size would be read beyond its end.
  std::string damaged = bytes;
  const std::size_t last_patch =
      damaged.size() - static_cast<std::size_t>(track::patch_side_px() * track::patch_side_px()) -
      8 - 8;
  damaged[last_patch] = 127;
  ByteReader reader(damaged);
  track::CornerPoints restored = walk.points();
  restored.restore(reader, walk.features(0));
  EXPECT_FALSE(reader.ok());
}

}  // namespace
}  // namespace hermite::pipeline::corner_points_test
