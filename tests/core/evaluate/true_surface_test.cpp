#include "core/evaluate/true_surface.h"
#include "core/source/open_sequence.h"

#include <gtest/gtest.h>

namespace hermite::evaluate {
namespace {

const std::string kSource = "synthetic:frames=6,rate=2,width=96,height=72";

TEST(TrueSurface, OfTheSyntheticRoomIsExactAndCoveredByItsOwnSamples) {
  const auto sequence = source::open_sequence(kSource);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  const auto surface = surface_of_sequence(**sequence, kSource);
  ASSERT_TRUE(surface.ok()) << surface.error().message;
  ASSERT_GT(surface->samples.size(), 10'000u);
  std::size_t on_surface_count = 0;
  for (const Eigen::Vector3d& sample : surface->samples)
    on_surface_count += surface->distance_m(sample) < 0.005 ? 1 : 0;
  // Triangles between pixels some centimetres apart cut the corners of furniture.
  EXPECT_GT(on_surface_count, surface->samples.size() * 95 / 100);
  EXPECT_NEAR(surface->distance_m({0.0, 0.0, -0.03}), 0.03, 1e-9) << "below the floor";
  EXPECT_EQ(surface->distance_m({0, 0, -5}), kSurfaceReach_m);
}

TEST(TrueSurface, NoiseAndGapsDoNotChangeTheFormulas) {
  const std::string source =
      "synthetic:frames=2,width=64,height=64,scene=twins+noise=kinect+missing=0:1";
  const auto sequence = source::open_sequence(source);
  ASSERT_TRUE(sequence.ok()) << sequence.error().message;
  const auto surface = surface_of_sequence(**sequence, source);
  ASSERT_TRUE(surface.ok()) << surface.error().message;
  EXPECT_NEAR(surface->distance_m({0.0, 0.0, 0.05}), 0.036, 1e-9) << "above the passage's rug";
}

TEST(TrueSurface, OfASequenceWithoutTruePosesIsAnError) {
  class NoTruth : public dataset::Sequence {
   public:
    std::string format() const override { return "none"; }
    std::string name() const override { return "none"; }
    const Camera& camera() const override { return camera_; }
    double frame_rate_hz() const override { return 30; }
    std::int64_t frame_count() const override { return 0; }
    double timestamp_s(std::int64_t) const override { return 0; }
    Result<dataset::RecordedFrame> read(std::int64_t) const override {
      return Error{ErrorCode::kNotFound, "none"};
    }
    const dataset::Trajectory& groundtruth() const override { return trajectory_; }

   private:
    Camera camera_;
    dataset::Trajectory trajectory_;
  };
  const auto surface = surface_of_sequence(NoTruth(), "none");
  ASSERT_FALSE(surface.ok());
  EXPECT_EQ(surface.error().code, ErrorCode::kNotFound);
}

TEST(TrueSurface, CompletenessIsTheShareThatTheCloudReaches) {
  TrueSurface surface;
  std::vector<Triangle> cloud;
  for (int i = 0; i < 10; ++i) {
    surface.samples.push_back({0.1 * i, 0, 0});
    const Eigen::Vector3f point(0.1f * static_cast<float>(i), 0,
                                i < 4   ? 0.003f
                                : i < 7 ? 0.008f
                                        : 0.05f);
    cloud.push_back({point, point, point});
  }
  const TriangleSurface grid(cloud, kSurfaceReach_m);
  EXPECT_DOUBLE_EQ(completeness(surface, grid, 0.005), 0.4);
  EXPECT_DOUBLE_EQ(completeness(surface, grid, 0.010), 0.7);
  EXPECT_EQ(completeness(TrueSurface{}, grid, 0.01), 0);
}

TEST(TrueSurface, OfTrianglesSamplesTheirMiddles) {
  const TrueSurface surface = surface_of_triangles(
      {{Eigen::Vector3f(0, 0, 0), Eigen::Vector3f(0.3f, 0, 0), Eigen::Vector3f(0, 0.3f, 0)}});
  ASSERT_EQ(surface.samples.size(), 1u);
  EXPECT_LT((surface.samples[0] - Eigen::Vector3d(0.1, 0.1, 0)).norm(), 1e-6);
  EXPECT_NEAR(surface.distance_m({0.05, 0.05, 0.02}), 0.02, 1e-6);
}

}  // namespace
}  // namespace hermite::evaluate
