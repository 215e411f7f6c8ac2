#include "core/adjust/features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>

#include "core/synthetic/synthetic_camera.h"

namespace hermite::adjust::features_test {
namespace {

const Camera kCamera{640, 480, 525, 525, 319.5, 239.5, 5000, {}};

Camera half_size() { return {320, 240, 262.5, 262.5, 159.5, 119.5, 5000, {}}; }

frame::RgbdFrame room_frame(const Camera& camera, double time_s = 0) {
  static const synthetic::SyntheticRoom room(synthetic::RoomScene::kRoom);
  synthetic::RoomView view = room.render(camera, synthetic::synthetic_pose(time_s, 1));
  return {time_s, std::move(view.depth), std::move(view.color)};
}

// Every image has some noise. Without any, neighbouring pixels are corners equally well, and FAST
// keeps none of equals.
Rgb8 noisy(Rgb8 color, std::mt19937& random) {
  const auto add = [&](std::uint8_t value) {
    return static_cast<std::uint8_t>(
        std::clamp(value + static_cast<int>(random() % 3) - 1, 0, 255));
  };
  return {add(color.r), add(color.g), add(color.b)};
}

frame::RgbdFrame grey_frame(const Camera& camera) {
  frame::RgbdFrame frame{0, DepthImage(camera.width, camera.height),
                         ColorImage(camera.width, camera.height)};
  std::fill(frame.depth.pixels.begin(), frame.depth.pixels.end(), std::uint16_t{5000});
  std::mt19937 random(1);
  for (Rgb8& pixel : frame.color.pixels) pixel = noisy({100, 100, 100}, random);
  return frame;
}

// Squares with four corners each.
void draw_squares(frame::RgbdFrame& frame, int left, int top, int right, int bottom, int pitch,
                  Rgb8 color) {
  std::mt19937 random(2);
  for (int y = top; y < bottom; ++y)
    for (int x = left; x < right; ++x)
      if ((x - left) % pitch < pitch / 2 && (y - top) % pitch < pitch / 2)
        frame.color.at(x, y) = noisy(color, random);
}

TEST(DetectFeatures, TheSameFrameGivesTheSameFeatures) {
  const frame::RgbdFrame frame = room_frame(kCamera);
  const std::vector<Feature> first = detect_features(frame, kCamera),
                             second = detect_features(frame, kCamera);
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].pixel_px, second[i].pixel_px);
    EXPECT_EQ(first[i].descriptor, second[i].descriptor);
    EXPECT_EQ(first[i].angle_rad, second[i].angle_rad);
    EXPECT_EQ(first[i].depth_m, second[i].depth_m);
  }
}

TEST(DetectFeatures, AFurnishedRoomGivesWhatWasAskedForOverAllOctaves) {
  const std::vector<Feature> features = detect_features(room_frame(kCamera), kCamera);
  EXPECT_EQ(features.size(), 1000u);
  std::set<int> octaves;
  for (const Feature& feature : features) octaves.insert(feature.octave);
  EXPECT_EQ(octaves.size(), static_cast<std::size_t>(kOctaveCount));
  EXPECT_TRUE(
      std::is_sorted(features.begin(), features.end(),
                     [](const Feature& a, const Feature& b) { return a.octave < b.octave; }));
}

TEST(DetectFeatures, TheirNumberGoesWithTheSide) {
  EXPECT_EQ(detect_features(room_frame(half_size()), half_size()).size(), 500u);
  FeatureOptions few;
  few.feature_count = 100;
  EXPECT_EQ(detect_features(room_frame(kCamera), kCamera, few).size(), 100u);
}

TEST(DetectFeatures, AGreyWallGivesNone) {
  EXPECT_TRUE(detect_features(grey_frame(kCamera), kCamera).empty());
}

TEST(DetectFeatures, TheSmallestImageIsNotTooSmall) {
  const Camera tiny{kMinImageSide_px, kMinImageSide_px, 60, 60, 31.5, 31.5, 5000, {}};
  frame::RgbdFrame frame = grey_frame(tiny);
  draw_squares(frame, 0, 0, 64, 64, 16, {10, 10, 10});
  const std::vector<Feature> features = detect_features(frame, tiny);
  ASSERT_FALSE(features.empty());
  for (const Feature& feature : features) {
    EXPECT_GE(feature.pixel_px.minCoeff(), 0);
    EXPECT_LE(feature.pixel_px.maxCoeff(), 63);
  }
}

// A strong texture in one corner has corners for everything; the faint squares elsewhere still get
// their part.
TEST(DetectFeatures, OneTexturedCornerDoesNotTakeThemAll) {
  frame::RgbdFrame frame = grey_frame(kCamera);
  draw_squares(frame, 0, 0, 200, 200, 10, {0, 0, 0});
  draw_squares(frame, 240, 240, 640, 480, 60, {115, 115, 115});
  const std::vector<Feature> features = detect_features(frame, kCamera);
  const auto faint = std::count_if(features.begin(), features.end(), [](const Feature& f) {
    return f.octave == 0 && f.pixel_px.minCoeff() > 230;
  });
  // 6 x 4 squares, of which the 7 at the rim are partly in the border.
  EXPECT_GE(faint, 4 * 6 * 4 - 2 * 16);
}

TEST(DetectFeatures, ACornerIsWhereItWasDrawnInEveryOctave) {
  frame::RgbdFrame frame = grey_frame(kCamera);
  // One square, 40 px a side, with corners at 299.5 and 339.5.
  draw_squares(frame, 300, 220, 340, 260, 80, {0, 0, 0});
  const std::vector<Feature> features = detect_features(frame, kCamera);
  std::set<int> octaves;
  for (const Feature& feature : features) {
    const auto off = [](float at, float low, float high) {
      return std::min(std::abs(at - low), std::abs(at - high));
    };
    // FAST marks a pixel inside the corner, two pixels from it at most.
    const double allowed_px = 2 * octave_scale(feature.octave);
    EXPECT_LE(off(feature.pixel_px.x(), 299.5f, 339.5f), allowed_px)
        << "octave " << int{feature.octave};
    EXPECT_LE(off(feature.pixel_px.y(), 219.5f, 259.5f), allowed_px)
        << "octave " << int{feature.octave};
    octaves.insert(feature.octave);
  }
  EXPECT_EQ(*octaves.begin(), 0);
  EXPECT_GE(octaves.size(), 4u);
}

TEST(DetectFeatures, TheAnglePointsToTheBrighterSide) {
  frame::RgbdFrame frame = grey_frame(kCamera);
  draw_squares(frame, 300, 220, 340, 260, 80, {255, 255, 255});
  int compared = 0;
  for (const Feature& feature : detect_features(frame, kCamera)) {
    if (feature.octave != 0) continue;
    ++compared;
    const double to_centre_rad =
        std::atan2(239.5f - feature.pixel_px.y(), 319.5f - feature.pixel_px.x());
    // The corner is found to a pixel of the disc's 15.
    EXPECT_NEAR(std::remainder(feature.angle_rad - to_centre_rad, 2 * M_PI), 0, 0.2);
  }
  EXPECT_GE(compared, 4);
}

// A quarter turn of the image turns pixels exactly, so that only the rounding of the rotated
// pattern is left.
TEST(DetectFeatures, DescriptorsTurnWithTheImage) {
  const Camera square{480, 480, 525, 525, 239.5, 239.5, 5000, {}};
  const frame::RgbdFrame frame = room_frame(square);
  frame::RgbdFrame turned = frame;
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 480; ++x) turned.color.at(479 - y, x) = frame.color.at(x, y);
  const std::vector<Feature> before = detect_features(frame, square),
                             after = detect_features(turned, square);
  int same = 0, compared = 0;
  for (const Feature& a : before)
    for (const Feature& b : after) {
      if (a.octave != 0 || b.octave != 0 ||
          b.pixel_px != Eigen::Vector2f(479 - a.pixel_px.y(), a.pixel_px.x()))
        continue;
      ++compared;
      EXPECT_NEAR(std::remainder(b.angle_rad - a.angle_rad - M_PI / 2, 2 * M_PI), 0, 1e-3);
      same += hamming(a.descriptor, b.descriptor) < 30;
    }
  EXPECT_GT(compared, 80);
  EXPECT_GT(same, compared * 9 / 10);
}

TEST(DetectFeatures, DepthIsThatOfTheSurface) {
  const frame::RgbdFrame frame = room_frame(kCamera);
  int with_depth = 0;
  for (const Feature& feature : detect_features(frame, kCamera)) {
    if (feature.depth_m == 0) continue;
    ++with_depth;
    const int x = static_cast<int>(std::lround(feature.pixel_px.x())),
              y = static_cast<int>(std::lround(feature.pixel_px.y()));
    // The median is that of a neighbour at most a pixel away, on a surface without an edge.
    EXPECT_NEAR(feature.depth_m, frame.depth.at(x, y) / 5000.0, 3 * 0.08);
    EXPECT_GE(feature.depth_m, kMinFeatureDepth_m);
    EXPECT_LE(feature.depth_m, kMaxFeatureDepth_m);
  }
  EXPECT_GT(with_depth, 500);
}

class DepthAt : public ::testing::Test {
 protected:
  DepthImage depth_{640, 480};
  void fill(double depth_m) {
    std::fill(depth_.pixels.begin(), depth_.pixels.end(),
              static_cast<std::uint16_t>(depth_m * 5000));
  }
};

TEST_F(DepthAt, IsTheMedianOfANoisySurface) {
  fill(2);
  depth_.at(100, 100) = 10050;  // one pixel 1 cm behind
  EXPECT_FLOAT_EQ(depth_at(depth_, kCamera, {100, 100}), 2);
}

TEST_F(DepthAt, OnADepthEdgeThereIsNone) {
  fill(2);
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 101; ++x) depth_.at(x, y) = 5000;
  for (int x = 100; x <= 101; ++x)
    EXPECT_EQ(depth_at(depth_, kCamera, Eigen::Vector2f(static_cast<float>(x), 100)), 0);
  EXPECT_FLOAT_EQ(depth_at(depth_, kCamera, {99, 100}), 1);
  EXPECT_FLOAT_EQ(depth_at(depth_, kCamera, {102, 100}), 2);
}

TEST_F(DepthAt, ASlopeIsNoEdge) {
  // A wall that stands at 55 degrees to the image, 1 m away in its middle.
  for (int y = 0; y < 480; ++y)
    for (int x = 0; x < 640; ++x)
      depth_.at(x, y) = static_cast<std::uint16_t>(
          5000 / (1 - std::tan(55 * M_PI / 180) * (x - 319.5) / 525 * 0.5));
  EXPECT_NEAR(depth_at(depth_, kCamera, {320, 240}), 1, 0.005);
}

TEST_F(DepthAt, HolesAndTheRangeOfTrust) {
  fill(2);
  for (int x = 99; x <= 101; ++x) depth_.at(x, 100) = depth_.at(x, 101) = 0;
  EXPECT_EQ(depth_at(depth_, kCamera, {100, 100}), 0);
  fill(0.25);
  EXPECT_EQ(depth_at(depth_, kCamera, {100, 100}), 0);
  fill(5.5);
  EXPECT_EQ(depth_at(depth_, kCamera, {100, 100}), 0);
  fill(4.9);
  EXPECT_NEAR(depth_at(depth_, kCamera, {100, 100}), 4.9, 1e-4);
}

TEST_F(DepthAt, OutsideTheImageThereIsNone) {
  fill(2);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const Eigen::Vector2f& pixel_px : {Eigen::Vector2f(-1, 5), Eigen::Vector2f(5, 480),
                                          Eigen::Vector2f(1e30f, 5), Eigen::Vector2f(nan, 5)})
    EXPECT_EQ(depth_at(depth_, kCamera, pixel_px), 0);
  EXPECT_FLOAT_EQ(depth_at(depth_, kCamera, {639, 240}), 2);  // six neighbours are left
}

}  // namespace
}  // namespace hermite::adjust::features_test
