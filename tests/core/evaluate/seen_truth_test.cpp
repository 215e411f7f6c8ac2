#include "core/evaluate/seen_truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/evaluate/true_surface.h"
#include "core/source/open_sequence.h"

namespace hermite::evaluate {
namespace {

using Eigen::Vector3d;

constexpr double kHalfWidth_m = 0.1, kBoxTop_m = 1.0, kFloor_m = 1.5;

// A camera that looks straight down at a box on a floor: the sides of the box cannot be seen, those
// of the ditch beside it can.
class BoxSequence : public dataset::Sequence {
 public:
  BoxSequence() {
    for (int i = 0; i < 3; ++i)
      trajectory_.push_back({0.1 * i, Rigid3{Eigen::Quaterniond::Identity(), {0.01 * i, 0, 0}}});
  }
  std::string format() const override { return "made up"; }
  std::string name() const override { return "box"; }
  const Camera& camera() const override { return camera_; }
  double frame_rate_hz() const override { return 10; }
  std::int64_t frame_count() const override { return 3; }
  double timestamp_s(std::int64_t index) const override { return 0.1 * static_cast<double>(index); }
  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    if (index == 1) return Error{ErrorCode::kCorruptData, "cut"};
    dataset::RecordedFrame frame{timestamp_s(index), DepthImage(camera_.width, camera_.height), {}};
    for (int y = 0; y < camera_.height; ++y)
      for (int x = 0; x < camera_.width; ++x)
        frame.depth.at(x, y) = static_cast<std::uint16_t>(
            std::lround(depth_m(index, x, y) * camera_.depth_units_per_metre));
    return frame;
  }
  const dataset::Trajectory& groundtruth() const override { return trajectory_; }

 private:
  // Of a roof (slopes of 45 degrees towards x = 0.3) that stands on the floor, and the box.
  double depth_m(std::int64_t index, int x, int y) const {
    const double eye_m = 0.01 * static_cast<double>(index), u = (x - camera_.cx) / camera_.fx,
                 v = (y - camera_.cy) / camera_.fy;
    if (std::abs(eye_m + u * kBoxTop_m) < kHalfWidth_m && std::abs(v * kBoxTop_m) < kHalfWidth_m)
      return kBoxTop_m;
    // z = 1.2 + |X - 0.3| with X = eye + u z.
    const double left_m = (1.2 + 0.3 - eye_m) / (1 + u), right_m = (1.2 - 0.3 + eye_m) / (1 - u);
    return std::min(kFloor_m, std::max(left_m, right_m));
  }

  Camera camera_{320, 240, 400, 400, 159.5, 119.5, 5000};
  dataset::Trajectory trajectory_;
};

SeenTruthOptions few_views() {
  SeenTruthOptions options;
  options.frame_stride = 1;
  options.view_count = 6;
  return options;
}

TEST(SeenTruth, CreasesAreWhereTheDepthBendsNotWhereItSteps) {
  const Result<SeenTruth> truth = seen_truth(BoxSequence(), "made up", few_views());
  ASSERT_TRUE(truth.ok()) << truth.error().message;
  ASSERT_GT(truth->creases.size(), 50u);
  int at_ridge = 0;
  for (const Vector3d& crease : truth->creases) {
    const double to_ridge_m = std::hypot(crease.x() - 0.3, crease.z() - 1.2),
                 to_foot_m = std::abs(crease.z() - kFloor_m);
    EXPECT_LT(std::min(to_ridge_m, to_foot_m), 0.025) << crease.transpose();
    at_ridge += to_ridge_m < 0.025 ? 1 : 0;
    const bool is_at_box =
        std::max(std::abs(crease.x()), std::abs(crease.y())) < 1.3 * kHalfWidth_m * kFloor_m;
    EXPECT_FALSE(is_at_box && crease.z() < 1.05) << "the edge of the box only hides what is behind";
  }
  EXPECT_GT(at_ridge, 20);
}

TEST(SeenTruth, SamplesAreThinnedAndLieOnTheSurface) {
  const Result<SeenTruth> truth = seen_truth(BoxSequence(), "made up", few_views());
  ASSERT_TRUE(truth.ok());
  // 1.2 m x 0.9 m of floor and a little more, in squares of 5 mm; every pixel of two frames would
  // be 153600.
  EXPECT_GT(truth->samples.size(), 30'000u);
  EXPECT_LT(truth->samples.size(), 100'000u);
  for (std::size_t i = 0; i < truth->samples.size(); i += 97)
    EXPECT_LT(truth->distance_m(truth->samples[i]), 0.002);
  EXPECT_NEAR(truth->distance_m({-0.05, 0.02, 1.03}), 0.03, 1e-3) << "under the top of the box";
  EXPECT_EQ(truth->distance_m({0, 0, 0.5}), kSurfaceReach_m);
}

TEST(SeenTruth, ViewsFromBesideThePathSeeWhatWasSeen) {
  const BoxSequence sequence;
  const Result<SeenTruth> truth = seen_truth(sequence, "made up", few_views());
  ASSERT_TRUE(truth.ok());
  ASSERT_EQ(truth->views.size(), 6u);
  EXPECT_EQ(truth->view_camera.width, 320);
  for (const BesideView& view : truth->views) {
    EXPECT_LT(view.world_from_camera.translation.norm(), 0.3);
    EXPECT_GT(view.world_from_camera.translation.norm(), 0.001) << "on the path";
    int drawn = 0, far = 0;
    for (int y = 0; y < 240; ++y)
      for (int x = 0; x < 320; ++x) {
        const auto depth_m = static_cast<double>(view.depth_m.at(x, y));
        if (depth_m == 0) continue;
        ++drawn;
        far += truth->distance_m(view.world_from_camera *
                                 truth->view_camera.unproject(x, y, depth_m)) > 0.002
                   ? 1
                   : 0;
      }
    EXPECT_GT(drawn, 20'000);
    EXPECT_EQ(far, 0);
  }
}

TEST(SeenTruth, OfTheSyntheticRoomIsExact) {
  const std::string source = "synthetic:frames=6,rate=2,width=96,height=72";
  const auto sequence = source::open_sequence(source + ",noise=kinect");
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  const Result<SeenTruth> truth = seen_truth(**sequence, source, few_views());
  ASSERT_TRUE(truth.ok()) << truth.error().message;
  EXPECT_NEAR(truth->distance_m({0.0, 0.0, -0.03}), 0.03, 1e-9) << "below the floor";
  ASSERT_EQ(truth->views.size(), 6u);
  for (const BesideView& view : truth->views)
    for (std::size_t i = 0; i < view.depth_m.pixels.size(); i += 31) {
      const auto x = static_cast<int>(i % 96), y = static_cast<int>(i / 96);
      const auto depth_m = static_cast<double>(view.depth_m.pixels[i]);
      if (depth_m == 0) continue;
      EXPECT_LT(
          truth->distance_m(view.world_from_camera * truth->view_camera.unproject(x, y, depth_m)),
          3e-4);
    }
}

TEST(SeenTruth, WithoutTruePosesThereIsNone) {
  class Unknown : public BoxSequence {
    const dataset::Trajectory& groundtruth() const override { return none_; }
    dataset::Trajectory none_;
  };
  const Result<SeenTruth> truth = seen_truth(Unknown(), "somewhere");
  ASSERT_FALSE(truth.ok());
  EXPECT_EQ(truth.error().code, ErrorCode::kNotFound);
}

}  // namespace
}  // namespace hermite::evaluate
