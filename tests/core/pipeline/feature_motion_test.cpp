#include "core/track/feature_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <cmath>

#include "tests/support/recording.h"

namespace hermite::pipeline::feature_motion_test {
namespace {

constexpr double kUnitsPerMetre = 1000;
const std::string kRoom = "synthetic:frames=12,width=320,height=240,rate=10";

struct Pair {
  test::Recording recording = test::record(kRoom);
  frame::ImageFeatures of(std::size_t frame) const {
    return frame::features_of(recording.frames[frame], recording.camera.depth_units_per_metre, {});
  }
  Rigid3 truth(std::size_t earlier, std::size_t frame) const {
    return inverse(recording.groundtruth[earlier].world_from_camera) *
           recording.groundtruth[frame].world_from_camera;
  }
};

std::optional<track::FeatureMotion> motion_by_features(const frame::ImageFeatures& earlier,
                                                       const frame::ImageFeatures& frame,
                                                       const Camera& camera) {
  std::vector<track::FollowedCorner> all, with_depth;
  for (const frame::Corner& corner : earlier.corners) {
    const auto place = earlier.levels.size() == frame.levels.size()
                           ? track::follow(earlier, frame, {corner.x, corner.y})
                           : std::nullopt;
    if (!place) continue;
    all.push_back({camera.unproject(double{corner.x}, double{corner.y}, 1), *place});
    if (corner.depth_m > 0)
      with_depth.push_back({double{corner.depth_m} * all.back().point_in_earlier, *place});
  }
  return track::motion_by_corners(all, with_depth, earlier.corners.size(), camera);
}

Vector6d error_of(const Rigid3& found, const Rigid3& truth) {
  return log_se3(inverse(truth) * found);
}

TEST(ImageFeatures, AreHalvesOfEachOtherAndCornersWithTheirDepth) {
  const Pair pair;
  const frame::ImageFeatures features = pair.of(0);
  EXPECT_EQ(features.image_px, 1);
  ASSERT_GE(features.levels.size(), 3u);
  for (std::size_t level = 1; level < features.levels.size(); ++level) {
    EXPECT_EQ(features.levels[level].width, features.levels[level - 1].width / 2);
    EXPECT_EQ(features.levels[level].pixels.size(),
              static_cast<std::size_t>(features.levels[level].width) *
                  static_cast<std::size_t>(features.levels[level].height));
  }
  ASSERT_GT(features.corners.size(), 50u);
  for (const frame::Corner& corner : features.corners) {
    if (corner.depth_m == 0) continue;
    const auto units =
        pair.recording.frames[0].depth.at(static_cast<int>(corner.x), static_cast<int>(corner.y));
    EXPECT_LT(std::abs(static_cast<double>(corner.depth_m) -
                       units / pair.recording.camera.depth_units_per_metre),
              0.3);
  }
}

TEST(ImageFeatures, OfAFlatImageHaveNoCorners) {
  const frame::RgbdFrame flat{0, DepthImage(160, 120), ColorImage(160, 120)};
  EXPECT_TRUE(frame::features_of(flat, kUnitsPerMetre, {}).corners.empty());
  EXPECT_FALSE(motion_by_features(frame::features_of(flat, kUnitsPerMetre, {}),
                                  frame::features_of(flat, kUnitsPerMetre, {}),
                                  Pair().recording.camera));
}

TEST(ImageFeatures, ComeBackFromBytes) {
  const frame::ImageFeatures features = Pair().of(0);
  for (const frame::ImageFeatures& saved : {features, frame::ImageFeatures{}}) {
    ByteWriter writer;
    frame::save(writer, saved);
    const std::string bytes = writer.take();
    ByteReader reader(bytes);
    frame::ImageFeatures restored;
    frame::restore(reader, restored);
    ASSERT_TRUE(reader.ok());
    ASSERT_EQ(restored.levels.size(), saved.levels.size());
    for (std::size_t level = 0; level < saved.levels.size(); ++level)
      EXPECT_EQ(restored.levels[level].pixels, saved.levels[level].pixels);
    EXPECT_EQ(restored.corners.size(), saved.corners.size());
  }
}

TEST(FeatureMotion, IsThatOfTheCamera) {
  const Pair pair;
  for (const std::size_t apart : {1u, 3u}) {
    const auto motion = motion_by_features(pair.of(2), pair.of(2 + apart), pair.recording.camera);
    ASSERT_TRUE(motion) << apart;
    EXPECT_FALSE(motion->is_turn_only);
    const Vector6d error = error_of(motion->earlier_from_frame, pair.truth(2, 2 + apart));
    EXPECT_LT(error.head<3>().norm(), 0.01) << apart;
    EXPECT_LT(error.tail<3>().norm(), 0.004) << apart;
    const track::CornerAgreement agreement = track::corners_at(*motion, pair.truth(2, 2 + apart));
    EXPECT_GT(agreement.share, 0.8);
    EXPECT_GE(agreement.count, 20);
    EXPECT_LT(track::corners_at(*motion, pair.truth(2, 2 + apart) *
                                             exp_se3((Vector6d() << 0, 0, 0, 0.1, 0, 0).finished()))
                  .share,
              0.2);
  }
}

// The terms lead from a start that is off back to where the corners agree.
TEST(FeatureMotion, TermsPullTowardsIt) {
  const Pair pair;
  const auto motion = motion_by_features(pair.of(4), pair.of(5), pair.recording.camera);
  ASSERT_TRUE(motion);
  Rigid3 pose = exp_se3((Vector6d() << 0.02, -0.01, 0.015, 0.01, -0.01, 0.01).finished()) *
                motion->earlier_from_frame;
  for (int step = 0; step < 10; ++step) {
    const track::NormalEquations terms = track::feature_terms(*motion, pose);
    pose = exp_se3(terms.hessian.ldlt().solve(terms.right_hand_side)) * pose;
  }
  const Vector6d error = error_of(pose, motion->earlier_from_frame);
  EXPECT_LT(error.head<3>().norm(), 0.002);
  EXPECT_LT(error.tail<3>().norm(), 0.001);
}

TEST(FeatureMotion, WithoutDepthIsATurn) {
  Pair pair;
  for (frame::RgbdFrame& frame : pair.recording.frames)
    frame.depth = DepthImage(frame.depth.width, frame.depth.height);
  const auto motion = motion_by_features(pair.of(2), pair.of(3), pair.recording.camera);
  ASSERT_TRUE(motion);
  EXPECT_TRUE(motion->is_turn_only);
  EXPECT_EQ(motion->earlier_from_frame.translation.norm(), 0);
  EXPECT_NEAR(angle_rad(motion->earlier_from_frame.rotation), angle_rad(pair.truth(2, 3).rotation),
              0.02);
}

TEST(FeatureMotion, FindsAPatchWhereItWasCutOutAndNowhereElse) {
  const frame::ImageFeatures features = Pair().of(0);
  ASSERT_GT(features.corners.size(), 50u);
  int far = 0;
  for (const frame::Corner& corner : features.corners) {
    const frame::GreyImage patch = track::patch_around(features.levels[0], corner);
    ASSERT_EQ(patch.width, patch.pixels.empty() ? 0 : track::patch_side_px());
    if (patch.pixels.empty()) continue;
    const Eigen::Vector2d at(corner.x, corner.y);
    const auto found =
        track::find_patch(patch, features.levels[0], at + Eigen::Vector2d(0.4, -0.3));
    ASSERT_TRUE(found);
    EXPECT_LT((*found - at).norm(), 0.1);
    far += track::find_patch(patch, features.levels[0], at + Eigen::Vector2d(25, 0)) ? 1 : 0;
  }
  EXPECT_LT(far, static_cast<int>(features.corners.size()) / 10);
  EXPECT_FALSE(track::find_patch({}, features.levels[0], {20, 20}));
  EXPECT_TRUE(track::patch_around(features.levels[0], {2, 2, 0}).pixels.empty());
}

TEST(FeatureMotion, OfOtherPlacesIsNone) {
  const Pair pair;
  const test::Recording other =
      test::record("synthetic:scene=office,frames=2,width=320,height=240");
  EXPECT_FALSE(motion_by_features(
      pair.of(0), frame::features_of(other.frames[1], other.camera.depth_units_per_metre, {}),
      pair.recording.camera));
  EXPECT_FALSE(motion_by_features({}, pair.of(0), pair.recording.camera));
}

}  // namespace
}  // namespace hermite::pipeline::feature_motion_test
