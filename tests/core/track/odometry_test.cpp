#include "core/track/odometry.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "tests/reference/frame_twin.h"
#include "tests/reference/track_twin.h"
#include "tests/support/analytic_scene.h"
#include "tests/support/gpu_test.h"
#include "tests/support/packing.h"

namespace hermite::track::odometry_test {
namespace {

using Eigen::Vector3d;
using test::SurfaceImage;
using testing::HasSubstr;

const Camera kCamera{160, 120, 130, 130, 79.5, 59.5, 5000};
constexpr double kGradientMin[frame::kPyramidLevels] = {5, 3, 1};  // grey values per pixel

// About a centimetre and a degree: what a hand does between two frames.
Rigid3 small_motion() {
  return exp_se3((Vector6d() << 0.012, -0.008, 0.010, 0.010, 0.015, -0.012).finished());
}

// Steps at one level only.
TrackOptions one_step_at(int level) {
  TrackOptions options;
  options.max_iterations_coarse = level == 2 ? 1 : 0;
  options.max_iterations_middle = level == 1 ? 1 : 0;
  options.max_iterations_fine = level == 0 ? 1 : 0;
  return options;
}

TrackOptions until_converged() {
  TrackOptions options;
  options.max_iterations_coarse = options.max_iterations_middle = options.max_iterations_fine = 30;
  return options;
}

class OdometryTest : public test::GpuTest {
 protected:
  using Levels = std::vector<SurfaceImage>;

  OdometryTest()
      : frame(test::make_frame_maps(device(), kCamera)),
        reference(frame::make_surface_pyramid(device(), frame::intrinsics_of(kCamera), "test")) {}

  static Levels render(const test::Scene& scene, const Rigid3& world_from_camera) {
    Levels levels;
    for (int level = 0; level < frame::kPyramidLevels; ++level)
      levels.push_back(
          test::render(scene, test::intrinsics_of_level(kCamera, level), world_from_camera));
    return levels;
  }
  void set_frame(const Levels& levels) {
    for (std::size_t level = 0; level < levels.size(); ++level) {
      test::upload(levels[level], frame.surface.levels[level]);
      const std::vector<float>& grey = levels[level].intensity;
      std::vector<shared::GreyAndGradient> pixels;
      for (const Eigen::Vector2d& g : test::gradient_twin(grey, levels[level].camera))
        pixels.push_back({grey[pixels.size()], test::pack_halves(g.x(), g.y())});
      frame.images[level].upload(pixels);
    }
  }
  void set_reference(const Levels& levels) {
    for (std::size_t level = 0; level < levels.size(); ++level)
      test::upload(levels[level], reference.levels[level]);
  }
  // The frame is seen from where `reference_from_camera` says, the reference from the origin.
  void set_both(const test::Scene& scene, const Rigid3& reference_from_camera) {
    set_frame(render(scene, reference_from_camera));
    set_reference(render(scene, Rigid3{}));
  }
  OdometryResult track(const TrackOptions& options, const Rigid3& guess = {}) {
    return Odometry(device(), frame::intrinsics_of(kCamera), options)
        .track(frame, reference, std::array{guess});
  }

  frame::FrameMaps frame;
  frame::SurfacePyramid reference;
};

void expect_close(const Rigid3& actual, const Rigid3& expected, double translation_m,
                  double rotation_deg) {
  const Rigid3 difference = inverse(expected) * actual;
  EXPECT_LT(difference.translation.norm(), translation_m);
  EXPECT_LT(angle_rad(difference.rotation) * 180 / M_PI, rotation_deg);
}

// A smooth surface without noise leaves the pairing of points by whole pixels: half of one is 4 mm
// here, which its curvature of 4 / m turns into some hundredths of a millimetre.
TEST_F(OdometryTest, GeometryAloneFindsASmallMotion) {
  set_both(test::wave_scene(1), small_motion());
  TrackOptions options = until_converged();
  options.geometric_weight = 1e9;  // beside it the image counts nothing
  const OdometryResult result = track(options);
  EXPECT_TRUE(is_believable(result.agreement, result.reference_from_camera, TrackOptions{}));
  expect_close(result.reference_from_camera, small_motion(), 1e-4, 0.005);
  EXPECT_LT(result.residual_rms_m, 5e-5);
  EXPECT_GT(result.inlier_ratio, 0.9);
}

// Grey values between pixels are interpolated: a tenth of a pixel of error at most, averaged over
// thousands.
TEST_F(OdometryTest, TheImageAloneFindsASmallMotion) {
  set_both(test::wave_scene(1), small_motion());
  TrackOptions options = until_converged();
  options.geometric_weight = 0;
  const OdometryResult result = track(options);
  EXPECT_TRUE(is_believable(result.agreement, result.reference_from_camera, TrackOptions{}));
  EXPECT_GT(result.photometric_count, 5000);
  expect_close(result.reference_from_camera, small_motion(), 5e-4, 0.03);
}

TEST_F(OdometryTest, BothTogetherFindASmallMotionWithTheDefaults) {
  set_both(test::wave_scene(1), small_motion());
  const OdometryResult result = track(TrackOptions{});
  EXPECT_TRUE(is_believable(result.agreement, result.reference_from_camera, TrackOptions{}));
  expect_close(result.reference_from_camera, small_motion(), 1e-4, 0.006);
}

TEST_F(OdometryTest, TheDissimilaritySearchFindsItToo) {
  set_both(test::wave_scene(1), small_motion());
  TrackOptions options = until_converged();
  options.dissimilarity_search = true;
  const OdometryResult result = track(options);
  EXPECT_TRUE(is_believable(result.agreement, result.reference_from_camera, TrackOptions{}));
  expect_close(result.reference_from_camera, small_motion(), 3e-4, 0.02);
}

TEST_F(OdometryTest, AGuessIsTheStartAndTheSameMotionTheEnd) {
  const Rigid3 motion = exp_se3((Vector6d() << 0.03, 0.02, -0.05, 0.02, 0.1, -0.03).finished());
  set_both(test::wave_scene(1), motion);
  const Rigid3 guess =
      exp_se3((Vector6d() << 0.005, -0.004, 0.003, 0.004, -0.006, 0.005).finished()) * motion;
  const OdometryResult result = track(until_converged(), guess);
  EXPECT_TRUE(is_believable(result.agreement, result.reference_from_camera, TrackOptions{}));
  expect_close(result.reference_from_camera, motion, 1.5e-4, 0.01);
}

TEST_F(OdometryTest, OfSeveralGuessesTheBestIsTaken) {
  const Rigid3 motion = exp_se3((Vector6d() << 0.03, 0.02, -0.05, 0.02, 0.1, -0.03).finished());
  set_both(test::wave_scene(1), motion);
  const Rigid3 wrong = exp_se3((Vector6d() << -0.03, 0.02, 0.08, 0, -0.1, 0).finished());
  TrackOptions options = one_step_at(0);
  for (const auto& guesses : {std::array{wrong, motion}, std::array{motion, wrong}}) {
    const OdometryResult result =
        Odometry(device(), frame::intrinsics_of(kCamera), options).track(frame, reference, guesses);
    expect_close(result.reference_from_camera, motion, 1e-3, 0.1);
  }
}

TEST_F(OdometryTest, AStillCameraStaysStillAndStopsEarly) {
  set_both(test::wave_scene(1), Rigid3{});
  const OdometryResult result = track(TrackOptions{});
  EXPECT_TRUE(is_believable(result.agreement, result.reference_from_camera, TrackOptions{}));
  expect_close(result.reference_from_camera, Rigid3{}, 1e-6, 1e-4);
  EXPECT_EQ(result.iteration_count, frame::kPyramidLevels) << "one step a level";
  EXPECT_NEAR(result.inlier_ratio, 1, 1e-9);
}

// H and b are as the twin has them: the step that solves them is the same. Half a dozen pairs at
// the gates may differ.
TEST_F(OdometryTest, OneStepAgreesWithTheTwinAtEveryLevel) {
  const Levels seen = render(test::wave_scene(1), small_motion()),
               expected_view = render(test::wave_scene(1), Rigid3{});
  set_frame(seen);
  set_reference(expected_view);
  const Rigid3 guess = exp_se3((Vector6d() << 0.002, 0, -0.001, 0, 0.002, 0.001).finished());
  for (const double geometric_weight : {0.0, 1000.0, 1e9})
    for (const int level : {0, 1, 2})
      for (const bool discount : {false, true}) {
        SCOPED_TRACE("level " + std::to_string(level) + ", weight " +
                     std::to_string(geometric_weight) + ", discount " + std::to_string(discount));
        TrackOptions options = one_step_at(level);
        options.geometric_weight = geometric_weight;
        options.discount_normal_noise = discount;
        const OdometryResult actual = track(options, guess);
        // Packed on the way, as the GPU has them.
        const SurfaceImage current =
            test::download(frame.surface.levels[static_cast<std::size_t>(level)]);
        const SurfaceImage model =
            test::download(reference.levels[static_cast<std::size_t>(level)]);
        const test::TrackStep expected =
            test::track_step_twin(current, test::gradient_twin(current.intensity, current.camera),
                                  model, guess, options, {10, 30}, kGradientMin[level]);
        EXPECT_NEAR(static_cast<double>(actual.inlier_count), expected.geometric_count, 6);
        EXPECT_NEAR(static_cast<double>(actual.photometric_count), expected.photometric_count, 6);
        EXPECT_NEAR(actual.residual_rms_m,
                    std::sqrt(expected.geometric_error_m2 / expected.geometric_count), 1e-5);
        const Vector6d step = log_se3(actual.reference_from_camera * inverse(guess));
        EXPECT_LT((step - expected.step).norm(), 0.01 * expected.step.norm())
            << step.transpose() << "\n"
            << expected.step.transpose();
        EXPECT_GT(expected.step.norm(), 0.01);
      }
}

TEST_F(OdometryTest, WeightsOfTheReferenceCount) {
  // Two planes at right angles to the view, told apart by their weights: the frame is pushed back
  // by 4 and by 8 mm.
  Levels model = render(test::plane_scene(1), Rigid3{}), seen = model;
  for (std::size_t level = 0; level < model.size(); ++level)
    for (std::size_t i = 0; i < model[level].size(); ++i) {
      const bool left = i % model[level].camera.width < model[level].camera.width / 2;
      model[level].weight[i] = left ? 3 : 1;
      seen[level].depth_m[i] += left ? 0.004f : 0.008f;
      seen[level].intensity[i] = model[level].intensity[i] = 100;
    }
  // Only z and tilts are determined; the others get the least step, none.
  set_frame(seen);
  set_reference(model);
  const OdometryResult result = track(one_step_at(0));
  EXPECT_GT(result.inlier_count, 1000);
  // A plane fitted to the step, its middle at the left's share: nearer to 4 mm than to 8.
  const double moved_m = -result.reference_from_camera.translation.z();
  EXPECT_GT(moved_m, 0.0045);
  EXPECT_LT(moved_m, 0.0065);
}

TEST_F(OdometryTest, ImagesOfNoiseSayNothing) {
  Levels model = render(test::plane_scene(1), Rigid3{}), seen = model;
  std::mt19937 random(1);
  const auto noise = [&random] { return static_cast<float>(random() % 100); };
  for (std::size_t level = 0; level < model.size(); ++level)
    for (std::size_t i = 0; i < model[level].size(); ++i) {
      model[level].intensity[i] = noise();
      seen[level].intensity[i] = noise();
    }
  set_frame(seen);
  set_reference(model);
  const OdometryResult blind = track(TrackOptions{});
  EXPECT_GT(blind.photometric_count, 1000);
  EXPECT_EQ(blind.witnesses.image.unit, 0);
  EXPECT_EQ(blind.witnesses.image.system.hessian.norm(), 0);
  EXPECT_LT(blind.observability, 1e-5) << "a bare wall";
  set_frame(model);  // the same noise is a texture
  EXPECT_GT(track(TrackOptions{}).witnesses.image.system.hessian.norm(), 0);
}

TEST_F(OdometryTest, PairsBeyondTheGatesDoNotCount) {
  set_reference(render(test::plane_scene(1), Rigid3{}));
  set_frame(render(test::plane_scene(1.12), Rigid3{}));
  EXPECT_EQ(track(one_step_at(0)).inlier_count, 0) << "12 cm apart";
  set_frame(render(test::plane_scene(1.08), Rigid3{}));
  EXPECT_GT(track(one_step_at(0)).inlier_count, 1000);
  for (const double degrees : {18.0, 22.0}) {
    set_frame(render(test::plane_scene(1, degrees * M_PI / 180), Rigid3{}));
    EXPECT_EQ(track(one_step_at(0)).inlier_count > 1000, degrees < 20);
  }
}

TEST_F(OdometryTest, HolesAreNoSurface) {
  Levels seen = render(test::wave_scene(1), small_motion()),
         model = render(test::wave_scene(1), Rigid3{});
  std::mt19937 random(1);
  for (Levels* levels : {&seen, &model})
    for (SurfaceImage& image : *levels)
      for (std::size_t i = 0; i < image.size(); ++i)
        if (random() % 2 == 0) {
          image.depth_m[i] = 0;
          image.normals[i].setZero();
          image.weight[i] = 0;
        }
  set_frame(seen);
  set_reference(model);
  const OdometryResult result = track(until_converged());
  EXPECT_TRUE(is_believable(result.agreement, result.reference_from_camera, TrackOptions{}));
  EXPECT_NEAR(result.inlier_ratio, 0.5, 0.05);
  expect_close(result.reference_from_camera, small_motion(), 3e-4, 0.02);
}

// Nothing holds a camera in front of a bare wall in the wall's own directions. It must not be
// carried off along them.
TEST_F(OdometryTest, ABareWallDoesNotCarryTheCameraAway) {
  std::mt19937 random(1);
  std::normal_distribution<float> noise_m(0, 0.002f);
  Levels seen = render(test::plane_scene(1.5), Rigid3{}),
         model = render(test::plane_scene(1.5), Rigid3{});
  for (std::size_t level = 0; level < seen.size(); ++level)
    for (std::size_t i = 0; i < seen[level].size(); ++i) {
      seen[level].depth_m[i] += noise_m(random);
      seen[level].normals[i] = Vector3d(5 * noise_m(random), 5 * noise_m(random), 1).normalized();
      model[level].normals[i] = Vector3d(5 * noise_m(random), 5 * noise_m(random), 1).normalized();
      seen[level].intensity[i] = model[level].intensity[i] = 100;
    }
  set_frame(seen);
  set_reference(model);
  const OdometryResult result = track(TrackOptions{});
  // Noise in the normals is all that says anything there, and it is not believed.
  EXPECT_LT(result.reference_from_camera.translation.norm(), 0.01);
  EXPECT_NEAR(result.reference_from_camera.translation.z(), 0, 2e-4)
      << "the wall itself holds this one";
}

TEST_F(OdometryTest, WithoutDepthNothingIsFound) {
  set_reference(render(test::wave_scene(1), Rigid3{}));
  const OdometryResult result = track(TrackOptions{});
  EXPECT_EQ(result.agreement.surface, 0);
  EXPECT_FALSE(is_believable(result.agreement, result.reference_from_camera, TrackOptions{}));
  EXPECT_EQ(result.inlier_count, 0);
  EXPECT_TRUE(is_finite(result.reference_from_camera));
}

TEST_F(OdometryTest, WithoutAReferenceNothingIsFound) {
  set_frame(render(test::wave_scene(1), Rigid3{}));
  const OdometryResult result = track(TrackOptions{});
  EXPECT_GT(result.agreement.surface, 0.9);
  EXPECT_EQ(result.agreement.overlap, 0);
  EXPECT_FALSE(is_believable(result.agreement, result.reference_from_camera, TrackOptions{}));
  EXPECT_TRUE(is_finite(result.reference_from_camera));
}

TEST_F(OdometryTest, ElsewhereItIsNotBelieved) {
  set_both(test::wave_scene(1), Rigid3{});
  set_frame(render(test::plane_scene(2), Rigid3{}));
  const OdometryResult result = track(TrackOptions{});
  EXPECT_FALSE(is_believable(result.agreement, result.reference_from_camera, TrackOptions{}));
  EXPECT_TRUE(is_finite(result.reference_from_camera));
}

// Turned away by 15 degrees and 12 cm beside: far outside what the usual gates let in.
TEST_F(OdometryTest, TheSearchFindsWhatTrackingCannot) {
  const Rigid3 motion = exp_se3((Vector6d() << 0.12, 0.02, -0.03, 0, 0.26, 0).finished());
  set_both(test::wave_scene(1), motion);
  const OdometryResult tracked = track(TrackOptions{});
  EXPECT_FALSE(is_believable(tracked.agreement, tracked.reference_from_camera, TrackOptions{}));
  const Rigid3 turned = exp_se3((Vector6d() << 0, 0, 0, 0, 0.2, 0).finished());
  Odometry odometry(device(), frame::intrinsics_of(kCamera), TrackOptions{});
  const OdometryResult found =
      odometry.search(frame, reference, std::array{Rigid3{}, inverse(turned), turned});
  EXPECT_TRUE(is_believable(found.agreement, found.reference_from_camera, TrackOptions{}));
  expect_close(found.reference_from_camera, motion, 1e-3, 0.05);
}

// The texture repeats after 30 cm, so that the frame fits as well from there.
TEST_F(OdometryTest, TheSearchSaysThatAPatternedWallFitsTwice) {
  const Rigid3 motion{Eigen::Quaterniond::Identity(), {0.2, 0, 0}};
  set_both(test::plane_scene(1), motion);
  Odometry odometry(device(), frame::intrinsics_of(kCamera), TrackOptions{});
  EXPECT_TRUE(odometry.search(frame, reference, std::array{Rigid3{}, motion}).is_ambiguous);
  EXPECT_FALSE(odometry.search(frame, reference, std::array{motion}).is_ambiguous);
}

// --- How a frame fits ---

class AgreementTest : public OdometryTest {
 protected:
  Agreement agreement(const Rigid3& reference_from_camera = {}) {
    return Odometry(device(), frame::intrinsics_of(kCamera), TrackOptions{})
        .agreement(frame, reference, reference_from_camera);
  }
  // Changes pixels of the level that is looked at; `from` is the share of the image's width where
  // it begins.
  template <class Change>
  static Levels changed(Levels levels, double from, Change change) {
    SurfaceImage& image = levels[1];
    for (std::uint32_t y = 0; y < image.camera.height; ++y)
      for (auto x = static_cast<std::uint32_t>(from * image.camera.width); x < image.camera.width;
           ++x)
        change(image, image.index(static_cast<int>(x), static_cast<int>(y)));
    return levels;
  }
};

TEST_F(AgreementTest, OfTheSameViewIsWhole) {
  set_both(test::wave_scene(1), Rigid3{});
  const Agreement same = agreement();
  EXPECT_EQ(same.overlap, 1);
  EXPECT_EQ(same.agreeing, 1);
  EXPECT_EQ(same.in_front, 0);
  EXPECT_NEAR(same.correlation, 1, 1e-4);
  EXPECT_NEAR(same.grey_deviation, same.reference_grey_deviation, 1e-3);
  EXPECT_NEAR(same.sharpness, 1, 1e-4);
}

TEST_F(AgreementTest, OfAnotherPoseOfTheSameSceneIsWholeAtThatPoseOnly) {
  set_both(test::wave_scene(1), small_motion());
  const Agreement at_pose = agreement(small_motion());
  EXPECT_GT(at_pose.overlap, 0.95);
  EXPECT_EQ(at_pose.agreeing, 1);
  EXPECT_GT(at_pose.correlation, 0.98);
  EXPECT_LT(agreement(exp_se3((Vector6d() << 0, 0, 0.1, 0, 0, 0).finished())).agreeing, 0.1);
}

TEST_F(AgreementTest, CountsWhatIsNearerThanTheMapAndWhatIsNotThere) {
  const Levels view = render(test::plane_scene(1.5), Rigid3{});
  set_reference(view);
  set_frame(
      changed(view, 0.75, [](SurfaceImage& image, std::size_t i) { image.depth_m[i] = 0.8f; }));
  Agreement a = agreement();
  EXPECT_NEAR(a.in_front, 0.25, 1e-6);
  EXPECT_NEAR(a.agreeing, 0.75, 1e-6);
  EXPECT_EQ(a.overlap, 1);
  set_frame(changed(view, 0.75, [](SurfaceImage& image, std::size_t i) { image.depth_m[i] = 0; }));
  a = agreement();
  EXPECT_NEAR(a.surface, 0.75, 1e-6);
  EXPECT_EQ(a.overlap, 1);
  set_frame(view);
  set_reference(
      changed(view, 0.75, [](SurfaceImage& image, std::size_t i) { image.depth_m[i] = 0; }));
  EXPECT_NEAR(agreement().overlap, 0.75, 1e-6);
}

TEST_F(AgreementTest, ForgivesBrightnessButNotAnotherImage) {
  const Levels view = render(test::wave_scene(1), Rigid3{});
  set_reference(view);
  set_frame(changed(view, 0, [](SurfaceImage& image, std::size_t i) {
    image.intensity[i] = 20 + 0.5f * image.intensity[i];
  }));
  EXPECT_NEAR(agreement().correlation, 1, 1e-4);
  EXPECT_NEAR(agreement().sharpness, 0.5, 1e-4);
  set_frame(changed(view, 0, [](SurfaceImage& image, std::size_t i) {
    image.intensity[i] = 255 - image.intensity[i];
  }));
  EXPECT_NEAR(agreement().correlation, -1, 1e-4);
  set_frame(changed(view, 0, [](SurfaceImage& image, std::size_t i) { image.intensity[i] = 255; }));
  EXPECT_NEAR(agreement().grey_deviation, 0, 1e-3);
  set_reference(
      changed(view, 0, [](SurfaceImage& image, std::size_t i) { image.intensity[i] = -1; }));
  EXPECT_EQ(agreement().correlation, 0) << "a map without colour";
}

TEST_F(AgreementTest, OfNothingIsNothing) {
  const Agreement none = agreement();
  EXPECT_EQ(none.surface + none.overlap + none.agreeing + none.in_front + none.correlation, 0);
}

// --- Rotation from grey images ---

class RotationTest : public OdometryTest {
 protected:
  using Panorama = std::function<double(const Vector3d& direction)>;

  // What a camera that only turns sees of a panorama infinitely far away.
  void set_panorama(const Panorama& panorama, const Eigen::Quaterniond& world_from_camera) {
    SurfaceImage image(test::intrinsics_of_level(kCamera, 1));
    for (int y = 0; y < static_cast<int>(image.camera.height); ++y)
      for (int x = 0; x < static_cast<int>(image.camera.width); ++x)
        image.intensity[image.index(x, y)] =
            static_cast<float>(panorama(world_from_camera * image.ray(x, y).normalized()));
    test::upload(image, frame.surface.levels[1]);
  }
  Eigen::Quaterniond align(const Panorama& panorama, const Eigen::Quaterniond& world_from_current) {
    Odometry odometry(device(), frame::intrinsics_of(kCamera), TrackOptions{});
    gpu::Commands commands(device());
    set_panorama(panorama, Eigen::Quaterniond::Identity());
    odometry.remember(commands, frame);
    commands.submit_and_wait();
    set_panorama(panorama, world_from_current);
    return odometry.align_rotation(frame);
  }
  static double smooth(const Vector3d& d) {
    return 128 + 40 * std::sin(9 * d.x() + 2 * d.y()) + 40 * std::cos(11 * d.y() - 3 * d.x()) +
           30 * std::sin(8 * d.x() * d.y() + 3);
  }
};

TEST_F(RotationTest, OfAFarImageIsFound) {
  for (const Vector3d& axis :
       {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1), Vector3d(0.5, -0.7, 0.5)})
    for (const double degrees : {-4.0, 0.5, 3.0}) {
      const Eigen::Quaterniond world_from_current(
          Eigen::AngleAxisd(degrees * M_PI / 180, axis.normalized()));
      const Eigen::Quaterniond current_from_previous = align(smooth, world_from_current);
      // A fiftieth of a pixel of 1.8 degrees.
      EXPECT_LT(angle_rad(current_from_previous * world_from_current) * 180 / M_PI, 0.04)
          << axis.transpose() << ", " << degrees;
    }
}

TEST_F(RotationTest, WithoutAnEarlierImageIsNone) {
  set_panorama(smooth, Eigen::Quaterniond::Identity());
  Odometry odometry(device(), frame::intrinsics_of(kCamera), TrackOptions{});
  EXPECT_EQ(angle_rad(odometry.align_rotation(frame)), 0);
}

TEST_F(RotationTest, OfAFlatImageIsNone) {
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.1, Vector3d::UnitX()));
  EXPECT_LT(angle_rad(align([](const Vector3d&) { return 255.0; }, turned)), 1e-6);
}

TEST_F(RotationTest, OfUnrelatedImagesIsAtLeastARotation) {
  std::mt19937 random(1);
  const Panorama noise = [&random](const Vector3d&) { return static_cast<double>(random() % 256); };
  for (int i = 0; i < 5; ++i) {
    const Eigen::Quaterniond rotation = align(noise, Eigen::Quaterniond::Identity());
    EXPECT_TRUE(rotation.coeffs().allFinite());
    EXPECT_NEAR(rotation.norm(), 1, 1e-9);
  }
}

}  // namespace
}  // namespace hermite::track::odometry_test
