#include "core/frame/preprocess.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "tests/reference/frame_twin.h"
#include "tests/support/analytic_scene.h"
#include "tests/support/gpu_test.h"
#include "tests/support/packing.h"

namespace hermite::frame::preprocess_test {
namespace {

using Eigen::Vector3d;
using test::SurfaceImage;

// Odd on purpose: the last workgroups and the last word of 16-bit depths are half empty.
const Camera kOdd{97, 65, 100, 100, 47.3, 31.8, 5000};
// The focal length that the oracles of the HRBF were measured with; half a millimetre would be too
// coarse a depth for them.
const Camera kKinect{97, 65, 528, 528, 48, 32, 20000};

// One unit in the last place of a float near 5 m is 0.5 um; a weighted mean of 169 values adds a
// few.
constexpr double kDepthLoss_m = 3e-6;
// Depths in whole sensor units tilt a normal from central differences: half a unit on either side
// of two pixels.
double quantisation_rad(const Camera& camera, double depth_m) {
  return 1 / camera.depth_units_per_metre / (2 * depth_m / camera.fx);
}

FrameOptions of_every_pixel(FrameOptions options) {
  options.sampling = 1;
  return options;
}

// Lets the depth through as it is: no neighbour has any weight.
FrameOptions unfiltered() {
  FrameOptions options;
  options.bilateral_sigma_space_px = 0.4;
  options.bilateral_noise_sigmas = 0.01;
  options.support_radius_scale = 4;  // what the oracles were measured with
  return options;
}

class PreprocessTest : public test::GpuTest {
 protected:
  // The maps of one frame. They stay valid until the next call.
  const FrameMaps& run(const Camera& camera, const FrameOptions& options, const RgbdFrame& frame) {
    preprocessor_ = std::make_unique<Preprocessor>(device(), camera, of_every_pixel(options));
    gpu::Commands commands(device());
    preprocessor_->run(commands, frame, 0);
    commands.submit_and_wait();
    return preprocessor_->maps();
  }
  const FrameMaps& run(const Camera& camera, const FrameOptions& options,
                       const test::Scene& scene) {
    return run(camera, options, test::grey_frame(test::render_depth(scene, camera)));
  }

 private:
  std::unique_ptr<Preprocessor> preprocessor_;
};

// A noisy slope with a step of 1 m, holes, and values outside the range.
DepthImage rough_depth(const Camera& camera, unsigned seed) {
  std::mt19937 random(seed);
  DepthImage depth(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const double z = (x < camera.width / 2 ? 1.0 : 2.0) + 0.003 * y +
                       0.01 * (static_cast<double>(random()) / 4294967296.0 - 0.5);
      const auto event = random() % 100;
      const double units = event < 5    ? 0
                           : event == 5 ? 1
                           : event == 6 ? 65535
                                        : z * camera.depth_units_per_metre;
      depth.at(x, y) = static_cast<std::uint16_t>(units);
    }
  return depth;
}

RgbdFrame colourful_frame(const Camera& camera, unsigned seed) {
  std::mt19937 random(seed);
  RgbdFrame frame{0, rough_depth(camera, seed), ColorImage(camera.width, camera.height)};
  for (Rgb8& c : frame.color.pixels) {
    const std::uint32_t bits = static_cast<std::uint32_t>(random());
    c = {static_cast<std::uint8_t>(bits), static_cast<std::uint8_t>(bits >> 8),
         static_cast<std::uint8_t>(bits >> 16)};
  }
  return frame;
}

TEST_F(PreprocessTest, RawDepthIsMetresInsideTheRangeOnly) {
  RgbdFrame frame = test::grey_frame(DepthImage(kOdd.width, kOdd.height));
  frame.depth.at(3, 2) = 5000;
  frame.depth.at(4, 2) = 1499;  // nearer than 0.3 m
  frame.depth.at(5, 2) = 1501;
  frame.depth.at(6, 2) = 24999;
  frame.depth.at(7, 2) = 25001;  // farther than 5 m
  frame.depth.at(kOdd.width - 1, kOdd.height - 1) = 10000;
  const std::vector<float> raw = run(kOdd, FrameOptions{}, frame).raw_depth_m.download();
  const auto at = [&](int x, int y) { return raw[frame.depth.index(x, y)]; };
  EXPECT_FLOAT_EQ(at(3, 2), 1);
  EXPECT_EQ(at(4, 2), 0);
  EXPECT_FLOAT_EQ(at(5, 2), 0.3002f);
  EXPECT_FLOAT_EQ(at(6, 2), 4.9998f);
  EXPECT_EQ(at(7, 2), 0);
  EXPECT_FLOAT_EQ(at(kOdd.width - 1, kOdd.height - 1), 2);
  EXPECT_EQ(at(0, 0), 0);
}

TEST_F(PreprocessTest, FilteredDepthAgreesWithItsTwin) {
  for (const double sigma_px : {6.0, 4.5, 1.5, 0.8}) {  // windows of a radius of 8, 6, 2 and 1
    FrameOptions options;
    options.bilateral_sigma_space_px = sigma_px;
    options.bilateral_noise_sigmas = 3;
    options.measure_noise = false;  // so that the window is of this width
    const FrameMaps& maps = run(kOdd, options, colourful_frame(kOdd, 1));
    const std::vector<float> raw = maps.raw_depth_m.download(),
                             filtered = maps.filtered_depth_m.download();
    const std::vector<double> expected =
        test::bilateral_twin(raw, maps.surface.levels[0].camera, options);
    double moved_m = 0;
    for (std::size_t i = 0; i < raw.size(); ++i) {
      ASSERT_NEAR(static_cast<double>(filtered[i]), expected[i], kDepthLoss_m)
          << "pixel " << i << ", sigma " << sigma_px;
      ASSERT_EQ(filtered[i] > 0, raw[i] > 0) << "holes stay holes";
      moved_m = std::max(moved_m, std::abs(static_cast<double>(filtered[i] - raw[i])));
    }
    EXPECT_GT(moved_m, 1e-3) << "it does filter";
  }
}

TEST_F(PreprocessTest, TheFilterLeavesPlanesWhereTheyAre) {
  FrameOptions options;
  options.bilateral_noise_sigmas = 100;  // so that all of the window counts
  const FrameMaps& maps = run(kKinect, options, test::plane_scene(1.5, M_PI / 3));
  const std::vector<float> raw = maps.raw_depth_m.download(),
                           filtered = maps.filtered_depth_m.download();
  const shared::Intrinsics& camera = maps.surface.levels[0].camera;
  constexpr int kRadius = 5;  // of the window: beyond the border of the image it is not whole
  double shift_m = 0;
  int count = 0;
  for (int y = kRadius; y + kRadius < static_cast<int>(camera.height); ++y)
    for (int x = kRadius; x + kRadius < static_cast<int>(camera.width); ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * camera.width + static_cast<std::size_t>(x);
      ASSERT_NEAR(filtered[i], raw[i], 0.05e-3) << x << ", " << y;  // a unit of depth
      shift_m += static_cast<double>(filtered[i] - raw[i]);
      ++count;
    }
  EXPECT_LT(std::abs(shift_m / count), 1e-6);
}

TEST_F(PreprocessTest, TheFilterKeepsAStep) {
  DepthImage depth(kOdd.width, kOdd.height);
  // A step of 100 mm, forty standard deviations.
  for (int y = 0; y < kOdd.height; ++y)
    for (int x = 0; x < kOdd.width; ++x) depth.at(x, y) = x < 40 ? 5000 : 5500;
  const std::vector<float> filtered =
      run(kOdd, FrameOptions{}, test::grey_frame(depth)).filtered_depth_m.download();
  for (std::size_t i = 0; i < filtered.size(); ++i)
    ASSERT_NEAR(static_cast<double>(filtered[i]), depth.pixels[i] / 5000.0, kDepthLoss_m) << i;
}

// Of the kernels, without their margins; zero where there is none.
std::vector<Vector3d> first_normals(const FrameMaps& maps) {
  const std::size_t width = maps.camera().width, height = maps.camera().height,
                    margin = HERMITE_KERNEL_MARGIN;
  const std::vector<shared::uvec4> kernels = maps.kernels.download();
  std::vector<shared::uint> packed;
  std::vector<bool> is_kernel;
  for (std::size_t y = 0; y < height; ++y)
    for (std::size_t x = 0; x < width; ++x) {
      const shared::uvec4& kernel =
          kernels[(y + margin) * HERMITE_KERNEL_STRIDE(width) + x + margin];
      packed.push_back(kernel.y);
      is_kernel.push_back(kernel.w != 0);
    }
  std::vector<Vector3d> normals = test::unpack_normals(packed);
  for (std::size_t i = 0; i < normals.size(); ++i)
    if (!is_kernel[i]) normals[i].setZero();
  return normals;
}

TEST_F(PreprocessTest, FirstNormalsAgreeWithTheirTwin) {
  const FrameOptions options;
  const FrameMaps& maps = run(kOdd, options, colourful_frame(kOdd, 2));
  const std::vector<Vector3d> normals = first_normals(maps);
  const std::vector<Vector3d> expected = test::normals_twin(
      maps.filtered_depth_m.download(), maps.surface.levels[0].camera, 0.5 * options.depth_gate_m);
  int count = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    ASSERT_EQ(normals[i].isZero(), expected[i].isZero()) << i;
    // x and y are what is stored. Differences of vertices a few millimetres apart keep four digits
    // of a float.
    ASSERT_LT((normals[i] - expected[i]).head<2>().norm(), 3 * test::kNormalLoss) << i;
    count += expected[i].isZero() ? 0 : 1;
  }
  EXPECT_GT(count, 4000);
}

TEST_F(PreprocessTest, FirstNormalsOfPlanesAreTheirs) {
  for (const double tilt_rad : {0.0, 0.5, -1.0}) {
    const Camera camera = kKinect;
    const FrameMaps& maps = run(camera, unfiltered(), test::plane_scene(1, tilt_rad));
    const std::vector<Vector3d> normals = first_normals(maps);
    const Vector3d expected(std::sin(tilt_rad), 0, std::cos(tilt_rad));
    // Borders too: one side is enough, at twice the loss.
    for (std::size_t i = 0; i < normals.size(); ++i)
      ASSERT_LT((normals[i] - expected).norm(),
                2.5 * quantisation_rad(camera, 1) + test::kNormalLoss)
          << i << ", tilt " << tilt_rad;
  }
}

TEST_F(PreprocessTest, AtAStepNormalsComeFromTheirOwnSide) {
  DepthImage depth(kOdd.width, kOdd.height);
  for (int y = 0; y < kOdd.height; ++y)
    for (int x = 0; x < kOdd.width; ++x) depth.at(x, y) = x < 40 ? 5000 : 10000;
  const std::vector<Vector3d> normals =
      first_normals(run(kOdd, FrameOptions{}, test::grey_frame(depth)));
  for (const Vector3d& normal : normals)
    ASSERT_LT((normal - Vector3d::UnitZ()).norm(), test::kNormalLoss);
}

TEST_F(PreprocessTest, ALonelyPixelHasNoNormal) {
  RgbdFrame frame = test::grey_frame(DepthImage(kOdd.width, kOdd.height));
  frame.depth.at(20, 20) = 5000;
  frame.depth.at(30, 20) = frame.depth.at(31, 20) = 5000;  // no extent in y
  for (const Vector3d& normal : first_normals(run(kOdd, FrameOptions{}, frame)))
    ASSERT_TRUE(normal.isZero());
}

// Curvature is a difference of large sums: floats keep three or four of its digits, halves three.
void expect_same_surface(const SurfaceImage& actual, const SurfaceImage& expected) {
  int valid_count = 0, other_count = 0;
  for (std::size_t i = 0; i < actual.size(); ++i) {
    valid_count += expected.depth_m[i] > 0 ? 1 : 0;
    if ((actual.depth_m[i] > 0) != (expected.depth_m[i] > 0)) {
      ++other_count;
      continue;
    }
    ASSERT_NEAR(static_cast<double>(actual.depth_m[i]), static_cast<double>(expected.depth_m[i]),
                kDepthLoss_m)
        << i;
    ASSERT_LT((actual.normals[i] - expected.normals[i]).head<2>().norm(), 2 * test::kNormalLoss)
        << i;
    const double largest = expected.curvatures[i].cwiseAbs().maxCoeff();
    ASSERT_LT((actual.curvatures[i] - expected.curvatures[i]).cwiseAbs().maxCoeff(),
              0.05 + 3 * test::kHalfLoss * largest)
        << i;
    ASSERT_NEAR(static_cast<double>(actual.weight[i]), static_cast<double>(expected.weight[i]),
                1e-4)
        << i;
  }
  EXPECT_GT(valid_count, static_cast<int>(actual.size() / 2)) << "too little to compare";
  // Pixels whose validity hangs on a kernel at the very end of its support, or on a curvature at
  // the very limit.
  EXPECT_LE(other_count, valid_count / 500);
}

TEST_F(PreprocessTest, TheSurfaceAgreesWithItsTwin) {
  for (const bool project : {true, false})
    for (const bool hrbf_confidence : {true, false}) {
      FrameOptions options;
      options.project_to_surface = project;
      options.hrbf_confidence = hrbf_confidence;
      const FrameMaps& maps = run(kOdd, options, colourful_frame(kOdd, 3));
      const SurfaceImage surface = test::download(maps.surface.levels[0]);
      SCOPED_TRACE(std::string(project ? "projected" : "not projected") +
                   (hrbf_confidence ? ", c_r" : ""));
      expect_same_surface(surface,
                          test::surface_twin(maps.filtered_depth_m.download(), first_normals(maps),
                                             surface.camera, options));
    }
}

TEST_F(PreprocessTest, APlaneIsItsOwnSurface) {
  for (const double tilt_rad : {0.0, 0.7}) {
    const FrameMaps& maps = run(kKinect, unfiltered(), test::plane_scene(1, tilt_rad));
    const std::vector<float> raw = maps.raw_depth_m.download();
    const SurfaceImage surface = test::download(maps.surface.levels[0]);
    for (int y = 4; y < kKinect.height - 4; ++y)
      for (int x = 4; x < kKinect.width - 4; ++x) {
        const std::size_t i = surface.index(x, y);
        // A frontal plane is a whole number of sensor units away; a tilted one is rounded to them,
        // and the surface smooths that.
        const double rounding_m = tilt_rad == 0 ? 0 : 1 / kKinect.depth_units_per_metre;
        ASSERT_NEAR(static_cast<double>(surface.depth_m[i]), static_cast<double>(raw[i]),
                    1e-6 + rounding_m)
            << i;
        // Rounded normals alone bend a plane by their loss over the support, about 1e-4 / 10 mm.
        const double bend_per_m =
            (test::kNormalLoss + (tilt_rad == 0 ? 0 : quantisation_rad(kKinect, 1))) / 0.01;
        ASSERT_LT(surface.curvatures[i].cwiseAbs().maxCoeff(), 3 * bend_per_m) << i;
      }
  }
}

// The estimator's known factor (hrbf_test.cpp): 1.295 at a kernel's centre, 1.346 once its vertex
// has moved and its own Hessian is left out.
TEST_F(PreprocessTest, CurvatureOfASphereIsPositiveAndOfABowlNegative) {
  constexpr double kRadius_m = 0.1;
  for (const bool project : {false, true})
    for (const double sign : {1.0, -1.0}) {
      FrameOptions options = unfiltered();
      options.project_to_surface = project;
      const SurfaceImage surface = test::download(
          run(kKinect, options,
              sign > 0 ? test::sphere_scene(1, kRadius_m) : test::bowl_scene(1, kRadius_m))
              .surface.levels[0]);
      double sum = 0;
      int count = 0;
      for (int y = 26; y <= 38; ++y)
        for (int x = 42; x <= 54; ++x, ++count) {
          const Eigen::Vector2d k = surface.curvatures[surface.index(x, y)];
          EXPECT_GE(k.x(), k.y());
          sum += 0.5 * k.sum();
        }
      // Sensor units make single values noisy: the mean over 169 pixels.
      EXPECT_NEAR(sign * sum / count * kRadius_m, project ? 1.346 : 1.295, 0.06)
          << (project ? "projected" : "at the vertex");
    }
}

// Confidence of planes under a full window, as in hrbf_test.cpp, at the principal point, where
// distortion is none.
TEST_F(PreprocessTest, ConfidenceOfPlanesIsAsMeasured) {
  struct Row {
    double depth_m, tilt_deg, confidence;
  };
  for (const Row& row : {Row{0.5, 0, 0.886}, Row{1.0, 0, 0.785}, Row{1.0, 60, 0.676},
                         Row{2.0, 0, 0.617}, Row{3.0, 0, 0.484}}) {
    FrameOptions options = unfiltered();
    options.project_to_surface = false;
    options.confidence_epsilon = 1000 * 525 / kKinect.fx;  // 1000 for these pixels, as in the table
    // 60 degrees at 1 m fall by 3.3 mm a pixel.
    options.depth_gate_m = 0.2;
    const SurfaceImage surface = test::download(
        run(kKinect, options, test::plane_scene(row.depth_m, row.tilt_deg * M_PI / 180))
            .surface.levels[0]);
    // Three digits, and normals that sensor units have tilted.
    EXPECT_NEAR(static_cast<double>(surface.weight[surface.index(48, 32)]), row.confidence, 2e-3)
        << row.depth_m << " m, " << row.tilt_deg;
  }
}

TEST_F(PreprocessTest, ConfidenceDoesNotDependOnTheNumberOfPixels) {
  std::vector<double> confidences;
  for (const double focal_px : {132.0, 528.0}) {
    const Camera camera{97, 65, focal_px, focal_px, 48, 32, 20000};
    const SurfaceImage surface =
        test::download(run(camera, unfiltered(), test::plane_scene(1)).surface.levels[0]);
    confidences.push_back(surface.weight[surface.index(48, 32)]);
  }
  EXPECT_NEAR(confidences[0], confidences[1], 1e-3);
}

TEST_F(PreprocessTest, ConfidenceFallsTowardsTheCorners) {
  FrameOptions options = unfiltered();
  options.hrbf_confidence = false;
  const SurfaceImage surface =
      test::download(run(kKinect, options, test::plane_scene(1)).surface.levels[0]);
  // exp(-gamma^2 / 0.72) with gamma 1 at half a diagonal from the principal point.
  const double half_diagonal2 = 0.25 * (97.0 * 97 + 65.0 * 65);
  for (const auto& [x, y] : {std::pair{48, 32}, {8, 32}, {48, 60}, {90, 6}}) {
    const double gamma2 = ((x - 48.0) * (x - 48) + (y - 32.0) * (y - 32)) / half_diagonal2;
    EXPECT_NEAR(static_cast<double>(surface.weight[surface.index(x, y)]), std::exp(-gamma2 / 0.72),
                1e-5)
        << x << ", " << y;
  }
}

TEST_F(PreprocessTest, FewerThanSixteenKernelsAreNoSurface) {
  // Patches of 3x5 and 4x4 pixels on nothing.
  RgbdFrame frame = test::grey_frame(DepthImage(kOdd.width, kOdd.height));
  for (int y = 20; y < 25; ++y)
    for (int x = 20; x < 23; ++x) frame.depth.at(x, y) = 5000;
  for (int y = 20; y < 24; ++y)
    for (int x = 60; x < 64; ++x) frame.depth.at(x, y) = 5000;
  FrameOptions options;
  options.support_radius_scale = 6;  // so that all sixteen reach the middle
  const SurfaceImage surface = test::download(run(kOdd, options, frame).surface.levels[0]);
  int small_count = 0, large_count = 0;
  for (int y = 0; y < kOdd.height; ++y)
    for (int x = 0; x < kOdd.width; ++x) {
      const bool valid = surface.depth_m[surface.index(x, y)] > 0;
      EXPECT_EQ(valid, !surface.normals[surface.index(x, y)].isZero());
      EXPECT_EQ(valid, surface.weight[surface.index(x, y)] > 0);
      (x < 40 ? small_count : large_count) += valid ? 1 : 0;
    }
  EXPECT_EQ(small_count, 0);
  EXPECT_EQ(large_count, 16);
}

TEST_F(PreprocessTest, CurvaturesBeyondTheLimitAreNoSurface) {
  FrameOptions options = unfiltered();
  options.curvature_limit_per_m = 20;  // the sphere below looks like 26 or 27
  const SurfaceImage surface =
      test::download(run(kKinect, options, test::sphere_scene(1, 0.05)).surface.levels[0]);
  EXPECT_EQ(surface.depth_m[surface.index(48, 32)], 0);
  options.curvature_limit_per_m = 100;
  const SurfaceImage wider =
      test::download(run(kKinect, options, test::sphere_scene(1, 0.05)).surface.levels[0]);
  EXPECT_GT(wider.depth_m[wider.index(48, 32)], 0);
}

std::vector<float> grey_of(const ColorImage& color) {
  std::vector<float> grey;
  for (const Rgb8 c : color.pixels)
    grey.push_back(static_cast<float>(0.299 * c.r + 0.587 * c.g + 0.114 * c.b));
  return grey;
}

TEST_F(PreprocessTest, GreyIsTheSmoothedWeightedSumOfColours) {
  const RgbdFrame frame = colourful_frame(kOdd, 4);
  const std::vector<float>
      grey = grey_of(frame.color),
      actual = run(kOdd, FrameOptions{}, frame).surface.levels[0].intensity.download();
  for (int y = 0; y < kOdd.height; ++y)
    for (int x = 0; x < kOdd.width; ++x) {
      double expected = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const int v = std::clamp(y + dy, 0, kOdd.height - 1),
                    u = std::clamp(x + dx, 0, kOdd.width - 1);
          expected += (2 - std::abs(dx)) * (2 - std::abs(dy)) / 16.0 *
                      static_cast<double>(grey[static_cast<std::size_t>(v * kOdd.width + u)]);
        }
      ASSERT_NEAR(static_cast<double>(actual[static_cast<std::size_t>(y * kOdd.width + x)]),
                  expected, 1e-3)
          << x << ", " << y;
    }
}

// Just beyond 320x240.
const Camera kLarge{322, 241, 300, 300, 160.3, 120.8, 5000};

TEST_F(PreprocessTest, AQuarterOfThePixelsIsMeasuredAsAllOfThemAre) {
  const RgbdFrame frame = colourful_frame(kLarge, 8);
  const FrameMaps& all = run(kLarge, FrameOptions{}, frame);
  const std::vector<float> raw = all.raw_depth_m.download(),
                           filtered = all.filtered_depth_m.download();
  const std::vector<float> intensity = all.surface.levels[0].intensity.download();
  const std::vector<shared::uint> color = all.color.download();
  const std::vector<shared::GreyAndGradient> grey_image = all.images[0].download();
  Preprocessor preprocessor(device(), kLarge, FrameOptions{});
  gpu::Commands commands(device());
  std::set<std::size_t> seen;
  for (std::int64_t frame_index = 0; frame_index < 4; ++frame_index) {
    const FrameMaps& maps = preprocessor.run(commands, frame, frame_index);
    commands.submit_and_wait();
    const shared::Intrinsics& camera = maps.camera();
    ASSERT_EQ(camera.width, 161u);
    ASSERT_EQ(camera.height, 120u);
    const auto quarter_raw = maps.raw_depth_m.download(),
               quarter_filtered = maps.filtered_depth_m.download();
    const auto quarter_intensity = maps.surface.levels[0].intensity.download();
    const auto quarter_color = maps.color.download();
    const auto quarter_image = maps.images[0].download();
    // Where the camera of the quarter says that its first pixel is.
    const auto x0 = static_cast<std::size_t>(
        std::lround(kLarge.cx - kLarge.fx * static_cast<double>(camera.cx / camera.fx)));
    const auto y0 = static_cast<std::size_t>(
        std::lround(kLarge.cy - kLarge.fy * static_cast<double>(camera.cy / camera.fy)));
    for (std::size_t i = 0; i < quarter_raw.size(); ++i) {
      const std::size_t j = (2 * (i / 161) + y0) * 322 + 2 * (i % 161) + x0;
      seen.insert(j);
      ASSERT_EQ(quarter_raw[i], raw[j]);
      ASSERT_NEAR(quarter_filtered[i], filtered[j], kDepthLoss_m);
      ASSERT_NEAR(quarter_intensity[i], intensity[j], 1e-3);
      ASSERT_EQ(quarter_color[i], color[j]);
      ASSERT_EQ(quarter_image[i].grey, quarter_intensity[i]);
      const Eigen::Vector2d slope = 2 * test::unpack_halves(grey_image[j].gradient);
      ASSERT_LT((test::unpack_halves(quarter_image[i].gradient) - slope).norm(),
                1e-3 + test::kHalfLoss * slope.norm())
          << i;
    }
  }
  EXPECT_EQ(seen.size(), 4u * 161 * 120) << "four frames see all pixels";
}

TEST_F(PreprocessTest, AQuarterOfThePixelsIsFilteredAsAllOfThemAreWhateverTheWindow) {
  const RgbdFrame frame = colourful_frame(kLarge, 9);
  for (const double sigma_px : {6.0, 4.5, 3.5, 0.8}) {
    FrameOptions options;
    options.bilateral_sigma_space_px = sigma_px;
    const std::vector<float> all = run(kLarge, options, frame).filtered_depth_m.download();
    Preprocessor preprocessor(device(), kLarge, options);
    gpu::Commands commands(device());
    for (std::int64_t frame_index = 0; frame_index < 4; ++frame_index) {
      const FrameMaps& maps = preprocessor.run(commands, frame, frame_index);
      commands.submit_and_wait();
      const std::vector<float> quarter = maps.filtered_depth_m.download();
      const shared::Sampling sampling = sampling_of_frame(2, frame_index);
      for (std::size_t i = 0; i < quarter.size(); ++i)
        ASSERT_NEAR(quarter[i],
                    all[(2 * (i / 161) + sampling.y) * 322 + 2 * (i % 161) + sampling.x],
                    kDepthLoss_m)
            << i << ", " << sigma_px;
    }
  }
}

TEST_F(PreprocessTest, ASmallImageIsTakenWhole) {
  Preprocessor preprocessor(device(), kOdd, FrameOptions{});
  EXPECT_EQ(preprocessor.maps().camera().width, 97u);
  EXPECT_EQ(preprocessor.maps().camera().height, 65u);
}

TEST_F(PreprocessTest, GradientsOfAllLevelsAgreeWithTheirTwin) {
  const RgbdFrame frame = colourful_frame(kOdd, 5);
  const FrameMaps& maps = run(kOdd, FrameOptions{}, frame);
  for (std::size_t level = 0; level < kPyramidLevels; ++level) {
    const SurfaceLevel& image = maps.surface.levels[level];
    // The finest level's is smoothed after, not before: a Sobel operator smooths by itself.
    const std::vector<Eigen::Vector2d> expected = test::gradient_twin(
        level == 0 ? grey_of(frame.color) : image.intensity.download(), image.camera);
    const std::vector<shared::GreyAndGradient> grey_image = maps.images[level].download();
    const std::vector<float> intensity = image.intensity.download();
    for (std::size_t i = 0; i < grey_image.size(); ++i) {
      ASSERT_EQ(grey_image[i].grey, intensity[i]) << level << ": " << i;
      const Eigen::Vector2d gradient = test::unpack_halves(grey_image[i].gradient);
      ASSERT_LT((gradient - expected[i]).norm(), 1e-3 + test::kHalfLoss * expected[i].norm())
          << level << ": " << i;
    }
  }
}

TEST_F(PreprocessTest, LevelsAgreeWithTheirTwins) {
  const FrameOptions options;
  const FrameMaps& maps = run(kOdd, options, colourful_frame(kOdd, 6));
  for (std::size_t level = 1; level < kPyramidLevels; ++level) {
    const SurfaceImage coarse = test::download(maps.surface.levels[level]);
    const SurfaceImage expected = test::downsample_twin(
        test::download(maps.surface.levels[level - 1]), coarse.camera, 0.5 * options.depth_gate_m);
    int count = 0;
    for (std::size_t i = 0; i < coarse.size(); ++i) {
      ASSERT_NEAR(static_cast<double>(coarse.depth_m[i]), static_cast<double>(expected.depth_m[i]),
                  kDepthLoss_m)
          << i;
      ASSERT_LT((coarse.normals[i] - expected.normals[i]).head<2>().norm(), test::kNormalLoss) << i;
      ASSERT_LT((coarse.curvatures[i] - expected.curvatures[i]).norm(),
                1e-3 + 2 * test::kHalfLoss * expected.curvatures[i].norm())
          << i;
      ASSERT_NEAR(static_cast<double>(coarse.weight[i]), static_cast<double>(expected.weight[i]),
                  1e-6)
          << i;
      ASSERT_NEAR(static_cast<double>(coarse.intensity[i]),
                  static_cast<double>(expected.intensity[i]), 1e-3)
          << i;
      count += coarse.depth_m[i] > 0 ? 1 : 0;
    }
    EXPECT_GT(count, static_cast<int>(coarse.size() / 10)) << "too little to compare";
  }
}

TEST_F(PreprocessTest, MasksTakeTheWeightOrTheGradientOfTheirPixelsAtAllLevels) {
  Preprocessor preprocessor(device(), kOdd, of_every_pixel({}));
  gpu::Commands commands(device());
  preprocessor.run(commands, colourful_frame(kOdd, 7), 0);
  commands.submit_and_wait();
  std::vector<std::vector<shared::SurfacePoint>> points;
  std::vector<std::vector<shared::GreyAndGradient>> images;
  for (std::size_t level = 0; level < kPyramidLevels; ++level) {
    points.push_back(preprocessor.maps().surface.levels[level].points.download());
    images.push_back(preprocessor.maps().images[level].download());
  }
  const shared::Intrinsics& coarsest = preprocessor.maps().surface.levels.back().camera;
  CoarseMask moving(std::size_t{coarsest.width} * coarsest.height, 0), light = moving;
  const std::size_t moving_cell = 5 * coarsest.width + 7, light_cell = 9 * coarsest.width + 12;
  moving[moving_cell] = light[light_cell] = 1;
  preprocessor.mask(commands, moving);
  preprocessor.mask_image(commands, light);
  commands.submit_and_wait();
  for (std::size_t level = 0; level < kPyramidLevels; ++level) {
    const SurfaceLevel& surface = preprocessor.maps().surface.levels[level];
    const std::vector<shared::SurfacePoint> points_now = surface.points.download();
    const std::vector<shared::GreyAndGradient> image_now =
        preprocessor.maps().images[level].download();
    const std::size_t shift = kPyramidLevels - 1 - level;
    for (std::size_t i = 0; i < points_now.size(); ++i) {
      const std::size_t x =
          std::min<std::size_t>((i % surface.camera.width) >> shift, coarsest.width - 1);
      const std::size_t y =
          std::min<std::size_t>((i / surface.camera.width) >> shift, coarsest.height - 1);
      const std::size_t cell = y * coarsest.width + x;
      ASSERT_EQ(points_now[i].weight, cell == moving_cell ? 0 : points[level][i].weight)
          << level << ": " << i;
      ASSERT_EQ(points_now[i].depth_m, points[level][i].depth_m);
      ASSERT_EQ(image_now[i].gradient, cell == light_cell ? 0 : images[level][i].gradient)
          << level << ": " << i;
      ASSERT_EQ(image_now[i].grey, images[level][i].grey);
    }
  }
}

TEST_F(PreprocessTest, TheNextFrameLeavesNothingOfTheLast) {
  Preprocessor preprocessor(device(), kOdd, of_every_pixel({}));
  gpu::Commands commands(device());
  preprocessor.run(commands, colourful_frame(kOdd, 7), 0);
  commands.submit_and_wait();
  preprocessor.run(commands, test::grey_frame(DepthImage(kOdd.width, kOdd.height), {0, 0, 0}), 1);
  commands.submit_and_wait();
  for (const SurfaceLevel& level : preprocessor.maps().surface.levels) {
    const SurfaceImage image = test::download(level);
    for (std::size_t i = 0; i < image.size(); ++i) {
      ASSERT_EQ(image.depth_m[i], 0);
      ASSERT_TRUE(image.normals[i].isZero());
      ASSERT_EQ(image.weight[i], 0);
      ASSERT_EQ(image.intensity[i], 0);
    }
  }
}

}  // namespace
}  // namespace hermite::frame::preprocess_test
