#include "core/map/predict.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/map/visible_blocks.h"
#include "tests/reference/frame_twin.h"
#include "tests/reference/map_twin.h"
#include "tests/support/analytic_scene.h"
#include "tests/support/gpu_test.h"
#include "tests/support/index_slots.h"
#include "tests/support/packing.h"

namespace hermite::map::predict_test {
namespace {

using Eigen::Vector3d;
using test::MapView;
using test::SurfaceImage;

const Camera kCamera{61, 43, 100, 102, 29.4, 20.7, 1000};
// What the oracles of the HRBF were measured with.
const Camera kKinect{61, 43, 528, 528, 30, 21, 1000};

// Positions and normals of kernels are packed into 16 bits on the way: 1e-4 over a support radius
// of 60 mm at most.
constexpr double kPlaneLoss_m = 6e-6;

// One surfel near every pixel's centre, `jitter_px` away at most, with the support radius of a
// measurement.
std::vector<Surfel> surfels_on(const test::Scene& scene, const Camera& camera, double jitter_px,
                               unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> jitter(-jitter_px, jitter_px);
  std::vector<Surfel> surfels;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const auto hit =
          scene(Vector3d::Zero(), camera.unproject(x + jitter(random), y + jitter(random), 1));
      Surfel s;
      s.position_in_submap_m = hit->position_m.cast<float>();
      s.normal_in_submap = hit->normal.cast<float>();
      s.radius_m = static_cast<float>(test::support_radius_m(frame::intrinsics_of(camera), 4,
                                                             hit->position_m.z(), hit->normal.z()));
      s.confidence = 5;
      surfels.push_back(s);
    }
  return surfels;
}

// Noise in everything, and attributes that tell surfels apart.
std::vector<Surfel> rough_surfels(unsigned seed) {
  std::vector<Surfel> surfels = surfels_on(test::wave_scene(1), kCamera, 0.45, seed);
  std::mt19937 random(seed + 1);
  std::normal_distribution<float> normal(0, 1);
  for (Surfel& s : surfels) {
    s.position_in_submap_m.z() += 0.001f * normal(random);
    s.normal_in_submap = (s.normal_in_submap +
                          0.05f * Eigen::Vector3f(normal(random), normal(random), normal(random)))
                             .normalized();
    s.radius_m *= 1 + 0.1f * std::clamp(normal(random), -2.0f, 2.0f);
    s.confidence = random() % 8 == 0 ? 0 : 3 + 20 * std::abs(normal(random));
    s.curvature_max_per_m = 20 + 10 * normal(random);
    s.curvature_min_per_m = s.curvature_max_per_m - 20;
    s.r = static_cast<std::uint8_t>(random());
    s.g = static_cast<std::uint8_t>(random());
    s.b = static_cast<std::uint8_t>(random());
  }
  return surfels;
}

class PredictTest : public test::GpuTest {
 protected:
  // Of an empty frame, so that nothing can stand in.
  SurfaceImage predict(const Camera& camera, const std::vector<Surfel>& surfels,
                       const MapOptions& options) {
    return predict(camera, surfels, options, SurfaceImage(frame::intrinsics_of(camera)));
  }
  SurfaceImage predict(const Camera& camera, const std::vector<Surfel>& surfels,
                       const MapOptions& options, const SurfaceImage& frame) {
    SurfelStore store(device());
    test::upload(surfels, store);
    store.set_camera(Rigid3{});
    VisibleBlocks visible(device(), options);
    IndexMap index(device(), frame::intrinsics_of(camera));
    Predictor predictor(device(), frame::intrinsics_of(camera), options);
    frame::FrameMaps maps = test::make_frame_maps(device(), camera);
    test::upload(frame, maps.surface.levels[0]);
    gpu::Commands commands(device());
    visible.list(commands, store, maps.camera(), 1);
    index.build(commands, store, maps.camera(), options.stable_confidence);
    predictor.run(commands, store, index, maps);
    commands.submit_and_wait();
    stored_ = store.download();
    ids_ = test::slots_of(index);
    return test::download(predictor.surface().levels[0]);
  }
  SurfaceImage twin(const Camera& camera, const MapOptions& options) const {
    return test::predict_twin(stored_, MapView{frame::intrinsics_of(camera)}, ids_, options);
  }

 private:
  std::vector<Surfel> stored_;  // of the last prediction, as the GPU has them
  std::vector<std::uint32_t> ids_;
};

// Pixels at least a window away from the border see all kernels.
template <class Body>
void for_inner_pixels(const SurfaceImage& image, Body body) {
  for (int y = 5; y < static_cast<int>(image.camera.height) - 5; ++y)
    for (int x = 5; x < static_cast<int>(image.camera.width) - 5; ++x)
      body(x, y, image.index(x, y));
}

TEST_F(PredictTest, PlanesAreExact) {
  for (const bool hrbf : {true, false})
    for (const double tilt_rad : {0.0, 0.4, -0.8}) {
      MapOptions options;
      options.hrbf_prediction = hrbf;
      const test::Scene scene = test::plane_scene(1, tilt_rad);
      const SurfaceImage actual = predict(kCamera, surfels_on(scene, kCamera, 0.4, 1), options);
      const SurfaceImage exact = test::render(scene, actual.camera);
      for_inner_pixels(actual, [&](int x, int y, std::size_t i) {
        ASSERT_NEAR(actual.depth_m[i], exact.depth_m[i], kPlaneLoss_m)
            << x << ", " << y << ", hrbf " << hrbf << ", tilt " << tilt_rad;
        ASSERT_LT((actual.normals[i] - exact.normals[i]).norm(), 2 * test::kNormalLoss)
            << x << ", " << y;
      });
    }
}

// The zero set lies 0.063 r^2 / R off a sphere (hrbf_test.cpp), unless corrected.
TEST_F(PredictTest, SpheresAreMetOutsideUnlessCorrected) {
  constexpr double kRadius_m = 0.1, kDepth_m = 1;
  const test::Scene scene = test::sphere_scene(kDepth_m, kRadius_m);
  const std::vector<Surfel> surfels = surfels_on(scene, kKinect, 0, 1);
  const double support_m = test::support_radius_m(frame::intrinsics_of(kKinect), 4, kDepth_m, 1);
  const double offset_m = 0.063 * support_m * support_m / kRadius_m;
  for (const bool correct : {true, false}) {
    MapOptions options;
    options.window = 7;  // what the bias was measured with
    options.correct_bias = correct;
    const SurfaceImage actual = predict(kKinect, surfels, options);
    const SurfaceImage exact = test::render(scene, actual.camera);
    double sum_m = 0, largest_m = 0;
    int count = 0;
    for (int y = 16; y <= 26; ++y)
      for (int x = 25; x <= 35; ++x, ++count) {
        const std::size_t i = actual.index(x, y);
        const double outside_m = exact.depth_m[i] - actual.depth_m[i];
        sum_m += outside_m;
        largest_m = std::max(largest_m, std::abs(outside_m));
      }
    if (correct)
      EXPECT_LT(largest_m, 4e-6) << "of " << offset_m;
    else
      EXPECT_NEAR(sum_m / count, offset_m, 0.1 * offset_m);
  }
}

// Where one of both decides otherwise about a kernel at the end of its support, or about two
// equally near ones.
void expect_same_surface(const SurfaceImage& actual, const SurfaceImage& expected,
                         double depth_loss_m) {
  int valid_count = 0, other_count = 0;
  for (std::size_t i = 0; i < actual.size(); ++i) {
    valid_count += expected.depth_m[i] > 0 ? 1 : 0;
    const bool same_source = std::abs(actual.intensity[i] - expected.intensity[i]) < 0.01;
    const bool same_normal = (actual.normals[i] - expected.normals[i]).norm() < 1e-2;
    if ((actual.depth_m[i] > 0) != (expected.depth_m[i] > 0) || !same_source || !same_normal) {
      ++other_count;
      continue;
    }
    ASSERT_NEAR(actual.depth_m[i], expected.depth_m[i], depth_loss_m) << i;
    if (expected.depth_m[i] <= 0) continue;
    ASSERT_LT((actual.curvatures[i] - expected.curvatures[i]).norm(), 1e-6) << i;
    ASSERT_NEAR(actual.weight[i], expected.weight[i], 1e-3 * expected.weight[i]) << i;
  }
  EXPECT_GT(valid_count, static_cast<int>(actual.size() * 9 / 10)) << "too little to compare";
  EXPECT_LE(other_count, valid_count / 100);
}

TEST_F(PredictTest, ARoughMapAgreesWithTheTwin) {
  for (const bool correct : {false, true}) {
    MapOptions options;
    options.correct_bias = correct;
    options.max_iterations = 20;  // as many as the twin takes at most
    const SurfaceImage actual = predict(kCamera, rough_surfels(3), options);
    SCOPED_TRACE(correct ? "corrected" : "plain");
    // Both stop within 10 um of the root; the correction is one step here and a whole iteration
    // there.
    expect_same_surface(actual, twin(kCamera, options), correct ? 1e-4 : 2e-5);
  }
}

TEST_F(PredictTest, FewStepsAlongTheRayAreEnough) {
  MapOptions options;
  const SurfaceImage actual = predict(kCamera, rough_surfels(4), options);
  options.max_iterations = 20;
  expect_same_surface(actual, predict(kCamera, rough_surfels(4), options), 1e-4);
}

TEST_F(PredictTest, SplattingARoughMapAgreesWithTheTwin) {
  MapOptions options;
  options.hrbf_prediction = false;
  const SurfaceImage actual = predict(kCamera, rough_surfels(5), options);
  expect_same_surface(actual, twin(kCamera, options), kPlaneLoss_m);
}

TEST_F(PredictTest, AttributesComeFromTheNearestSurfel) {
  std::vector<Surfel> surfels = surfels_on(test::plane_scene(1), kCamera, 0, 1);
  const std::size_t marked = 20 * 61 + 30;
  surfels[marked].r = surfels[marked].g = surfels[marked].b = 200;
  surfels[marked].curvature_max_per_m = 30;
  surfels[marked].curvature_min_per_m = -40;
  surfels[marked].confidence = 64;
  for (const bool curvature_weight : {false, true}) {
    MapOptions options;
    options.curvature_weight = curvature_weight;
    const double feature = curvature_weight ? std::exp(-100.0 / (2 * 40 * 40)) : 0;
    const SurfaceImage actual = predict(kCamera, surfels, options);
    for (int y = 18; y <= 22; ++y)
      for (int x = 28; x <= 32; ++x) {
        const std::size_t i = actual.index(x, y);
        EXPECT_NEAR(actual.intensity[i], i == marked ? 200 : 0, 1e-3);
        EXPECT_EQ(actual.curvatures[i],
                  i == marked ? Eigen::Vector2d(30, -40) : Eigen::Vector2d(0, 0));
        EXPECT_NEAR(actual.weight[i], i == marked ? 64.0 / 256 + feature : 5.0 / 256, 1e-4);
      }
  }
}

TEST_F(PredictTest, NeedsEnoughKernels) {
  const std::vector<Surfel> all = surfels_on(test::plane_scene(1), kCamera, 0, 1);
  std::vector<Surfel> few;
  const auto add_row = [&](int first_x, int y, int count) {
    for (int x = first_x; x < first_x + count; ++x)
      few.push_back(all[static_cast<std::size_t>(y * kCamera.width + x)]);
  };
  add_row(10, 10, 7);
  add_row(10, 30, 6);
  MapOptions options;
  options.window = 7;
  SurfaceImage actual = predict(kCamera, few, options);
  EXPECT_NEAR(actual.depth_m[actual.index(13, 10)], 1, kPlaneLoss_m);
  EXPECT_EQ(actual.depth_m[actual.index(12, 30)], 0);
  EXPECT_TRUE(actual.normals[actual.index(12, 30)].isZero());
  EXPECT_EQ(actual.weight[actual.index(12, 30)], 0);
  EXPECT_EQ(actual.intensity[actual.index(12, 30)], -1);
  options.min_support = 6;
  actual = predict(kCamera, few, options);
  EXPECT_NEAR(actual.depth_m[actual.index(12, 30)], 1, kPlaneLoss_m);
}

TEST_F(PredictTest, TheWindowIsAsWideAsSaid) {
  // Nothing within `hole` pixels of the middle; supports that would reach across.
  const auto with_hole = [](int hole) {
    std::vector<Surfel> surfels = surfels_on(test::plane_scene(1), kCamera, 0, 1);
    for (int y = 21 - hole; y <= 21 + hole; ++y)
      for (int x = 30 - hole; x <= 30 + hole; ++x)
        surfels[static_cast<std::size_t>(y * kCamera.width + x)].confidence = 0;
    for (Surfel& s : surfels) s.radius_m *= 2;
    return surfels;
  };
  for (const int window : {5, 7, 9})
    for (const int hole : {1, 2, 3, 4}) {
      MapOptions options;
      options.window = window;
      const SurfaceImage actual = predict(kCamera, with_hole(hole), options);
      EXPECT_EQ(actual.depth_m[actual.index(30, 21)] > 0, hole < window / 2)
          << "window " << window << ", hole " << hole;
    }
}

TEST_F(PredictTest, BackSidesAndWeakSurfelsAreNoKernels) {
  std::vector<Surfel> surfels = surfels_on(test::plane_scene(1), kCamera, 0, 1);
  for (Surfel& s : surfels) {
    const bool left = s.position_in_submap_m.x() < 0;
    if (left) s.normal_in_submap = -s.normal_in_submap;
    if (!left) s.confidence = 2.9f;
  }
  const SurfaceImage actual = predict(kCamera, surfels, MapOptions{});
  for (const float z : actual.depth_m) ASSERT_EQ(z, 0);
}

// The left half of the view is mapped, the frame sees all of it 5 cm farther away.
struct HalfMapped {
  std::vector<Surfel> surfels = surfels_on(test::plane_scene(1), kCamera, 0, 1);
  SurfaceImage frame = test::render(test::plane_scene(1.05), frame::intrinsics_of(kCamera));
  HalfMapped() {
    std::erase_if(surfels, [](const Surfel& s) { return s.position_in_submap_m.x() > 0; });
    for (std::size_t i = 0; i < frame.size(); ++i) {
      frame.weight[i] = 0.5f;
      frame.curvatures[i] = {20, 4};
    }
    frame.depth_m[frame.index(55, 5)] = 0;
  }
};

TEST_F(PredictTest, TheFrameStandsInWhereTheMapCoversTooLittle) {
  const HalfMapped half;
  const MapOptions options;
  const SurfaceImage actual = predict(kCamera, half.surfels, options, half.frame);
  const std::size_t mapped = actual.index(10, 20), filled = actual.index(50, 20),
                    empty = actual.index(55, 5);
  EXPECT_NEAR(actual.depth_m[mapped], 1, kPlaneLoss_m) << "the map goes first";
  EXPECT_EQ(actual.depth_m[filled], half.frame.depth_m[filled]);
  EXPECT_LT((actual.normals[filled] - Vector3d::UnitZ()).norm(), test::kNormalLoss);
  EXPECT_EQ(actual.curvatures[filled], Eigen::Vector2d(20, 4));
  EXPECT_NEAR(actual.weight[filled], test::tracking_weight_twin({20, 4}, 0.5, 1.05, options), 1e-5);
  EXPECT_EQ(actual.intensity[filled], half.frame.intensity[filled]);
  EXPECT_EQ(actual.depth_m[empty], 0) << "neither sees anything";
  EXPECT_EQ(actual.intensity[empty], -1);
}

TEST_F(PredictTest, StandingInDependsOnTheShareCovered) {
  const HalfMapped half;
  MapOptions options;
  options.fill_in_below = 0;
  const SurfaceImage bare = predict(kCamera, half.surfels, options, half.frame);
  const auto covered = static_cast<double>(
      std::count_if(bare.depth_m.begin(), bare.depth_m.end(), [](float z) { return z > 0; }));
  const double share = covered / static_cast<double>(bare.size());
  ASSERT_NEAR(share, 0.5, 0.06);
  EXPECT_EQ(bare.depth_m[bare.index(50, 20)], 0);
  options.fill_in_below = share - 0.001;
  const SurfaceImage enough = predict(kCamera, half.surfels, options, half.frame);
  EXPECT_EQ(enough.depth_m[enough.index(50, 20)], 0);
  options.fill_in_below = share + 0.001;
  const SurfaceImage too_little = predict(kCamera, half.surfels, options, half.frame);
  EXPECT_GT(too_little.depth_m[too_little.index(50, 20)], 0);
}

}  // namespace
}  // namespace hermite::map::predict_test
