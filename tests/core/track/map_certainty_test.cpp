#include "core/track/map_certainty.h"

#include <gtest/gtest.h>

#include <cmath>

namespace hermite::track::map_certainty_test {
namespace {

constexpr shared::Intrinsics kCamera{65.6f, 65.6f, 39.5f, 29.5f, 80, 60};

// The inside of a box, half of whose sides are these [m], seen by a sensor that bends depth by a
// share in the corners of the image.
frame::CoarseView box_seen(const Rigid3& world_from_camera, double bend) {
  const Eigen::Vector3d half(2.2, 1.3, 1.9);
  frame::CoarseView view{kCamera, std::vector<float>(4800), std::vector<Eigen::Vector3f>(4800),
                         std::vector<float>(4800, 100)};
  const double corner_px2 = 39.5 * 39.5 + 29.5 * 29.5;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 80; ++x) {
      const Eigen::Vector3d ray((x - 39.5) / 65.6, (y - 29.5) / 65.6, 1),
          along = world_from_camera.rotation * ray;
      double nearest_m = 1e9;
      Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();
      for (int axis = 0; axis < 3; ++axis) {
        const double sign = along[axis] > 0 ? 1 : -1,
                     z = (sign * half[axis] - world_from_camera.translation[axis]) / along[axis];
        if (z < nearest_m) {
          nearest_m = z;
          normal = sign * Eigen::Vector3d::Unit(axis);
        }
      }
      const double rho2 = ((x - 39.5) * (x - 39.5) + (y - 29.5) * (y - 29.5)) / corner_px2;
      view.depth_m[view.index(x, y)] = static_cast<float>(nearest_m * (1 + bend * rho2));
      view.normals[view.index(x, y)] =
          (world_from_camera.rotation.conjugate() * normal).cast<float>();
    }
  return view;
}

// Turned about the upright axis, which is y.
Rigid3 at(double x_m, double z_m, double turn_deg) {
  Rigid3 pose = exp_se3((Vector6d() << 0, 0, 0, 0, turn_deg * M_PI / 180, 0).finished());
  pose.translation = Eigen::Vector3d(x_m, 0, z_m);
  return pose;
}

class Walk {
 public:
  explicit Walk(double bend = 0) : bend_(bend) {}

  PoseUncertainty see(const Rigid3& world_from_camera, MapCertainty::StepError step = {}) {
    step.covariance = kStep;
    step.timestamp_s = time_s += 1.0 / 30;
    return certainty.observe(box_seen(world_from_camera, bend_), frame::CoarseMask(4800, 0),
                             world_from_camera, step, {submaps, is_active, current, closures});
  }

  // About the world's origin: a third of a millimetre and of a milliradian.
  const Matrix6d kStep = 1e-7 * Matrix6d::Identity();
  MapCertainty certainty;
  std::vector<Rigid3> submaps{Rigid3{}};
  std::vector<bool> is_active{true};
  std::uint32_t current = 0;
  std::uint64_t closures = 0;
  double time_s = 0;

 private:
  const double bend_;
};

TEST(MapCertainty, BeginsWithNothingAndGrowsOnNewGround) {
  Walk walk;
  EXPECT_LT(walk.see(at(0, 0, 0)).position_sigma_m(), 1e-3) << "the first frame is the world";
  double before_m = 0;
  for (const double turn_deg : {30, 60, 90, 120, 150}) {
    const double sigma_m = walk.see(at(0, 0, turn_deg)).position_sigma_m();
    EXPECT_GT(sigma_m, before_m) << turn_deg;
    before_m = sigma_m;
  }
}

// What is not known of a camera bends the path; a camera that was calibrated does so less.
TEST(MapCertainty, OfAKnownCameraLessIsStated) {
  const auto far_sigma_m = [](const CameraDoubts& deviations) {
    Walk walk;
    walk.certainty.begin_with(deviations);
    EXPECT_LE(walk.certainty.camera_error_rms().maxCoeff(), 0.010);
    for (int turn_deg = 0; turn_deg < 150; turn_deg += 20) walk.see(at(0, 0, turn_deg));
    return walk.see(at(0, 0, 150)).position_sigma_m();
  };
  const double unknown_m = far_sigma_m(CameraDoubts::Zero());
  EXPECT_LT(far_sigma_m({0.001, 0.0015, 0.003}), 0.8 * unknown_m);
  EXPECT_EQ(far_sigma_m(CameraDoubts::Constant(0.1)), unknown_m) << "worse than never checked";
  MapCertainty certainty;
  certainty.begin_with({0.001, 0, 0.002});
  EXPECT_NEAR(certainty.camera_error_rms()[kBendDoubt], 0.001, 1e-12);
  EXPECT_NEAR(certainty.camera_error_rms()[kFocalDoubt], 0.004, 1e-12) << "as it begins";
  EXPECT_NEAR(certainty.camera_error_rms()[kRadialDoubt], 0.002, 1e-12);
}

// If a check of the camera says nothing, or the contrary, the earlier calibration was of another.
TEST(MapCertainty, WhatIsNotConfirmedOfACameraIsForgotten) {
  const auto seen = [](const CameraDoubts& deviations, const auto& in_between) {
    Walk walk;
    walk.certainty.begin_with(deviations);
    for (int turn_deg = 0; turn_deg < 150; turn_deg += 20) walk.see(at(0, 0, turn_deg));
    in_between(walk.certainty);
    return walk.see(at(0, 0, 150)).position_sigma_m();
  };
  const CameraDoubts calibrated(0.001, 0.0015, 0.003), nothing = CameraDoubts::Zero();
  const auto forget = [](MapCertainty& certainty) { certainty.forget_calibration(); };
  const auto keep = [](MapCertainty&) {};
  const double unknown_m = seen(nothing, keep);
  EXPECT_EQ(seen(nothing, forget), unknown_m) << "there was nothing to forget";
  EXPECT_LT(seen(calibrated, keep), 0.8 * unknown_m);
  EXPECT_NEAR(seen(calibrated, forget), unknown_m, 0.15 * unknown_m);
  const auto observe = [](double focal) {
    return [focal](MapCertainty& certainty) {
      certainty.observe_camera({0, focal, 0}, {0.01, 0.002, 0.01});
    };
  };
  EXPECT_LT(seen(calibrated, observe(0.001)), seen(calibrated, keep));
  EXPECT_GT(seen(calibrated, observe(0.02)), 2 * seen(calibrated, keep));
}

TEST(MapCertainty, OldGroundBoundsIt) {
  Walk walk;
  walk.see(at(0, 0, 0));
  const double at_first_m = walk.see(at(0.02, 0, 1)).position_sigma_m();
  for (int turn_deg = 20; turn_deg <= 160; turn_deg += 20) walk.see(at(0, 0, turn_deg));
  const double far_m = walk.see(at(0.02, 0, 161)).position_sigma_m();
  for (int turn_deg = 160; turn_deg > 0; turn_deg -= 20) walk.see(at(0, 0, turn_deg));
  const double back_m = walk.see(at(0.02, 0, 1)).position_sigma_m();
  EXPECT_GT(far_m, 2 * at_first_m);
  EXPECT_NEAR(back_m, at_first_m, 0.2 * at_first_m);
}

// If surfaces disagree four times as much as usual, all variances grow so, except for what errors
// of the camera explain.
TEST(MapCertainty, GrowsIfSurfacesDisagreeMoreThanUsual) {
  double as_usual_m = 0;
  for (const double disagreement : {1.0, 2.0, 80.0}) {
    Walk walk;
    walk.see(at(0, 0, 0));
    const double sigma_m =
        walk.see(at(0.02, 0, 20), {.disagreement = disagreement}).position_sigma_m();
    if (disagreement == 1) as_usual_m = sigma_m;
    if (disagreement < 80) {
      EXPECT_EQ(sigma_m, as_usual_m) << disagreement;
    } else {
      EXPECT_GT(sigma_m, 1.01 * as_usual_m);
      EXPECT_LT(sigma_m, 1.1 * as_usual_m);
    }
  }
}

// Of more than 160 views some are dropped.
TEST(MapCertainty, ALongWayThroughOneRoomStaysBounded) {
  Walk walk;
  double after_a_turn_m = 0, last_m = 0;
  for (int i = 0; i <= 200; ++i) {
    last_m = walk.see(at(0.4 * (i % 2), 0, 18 * i)).position_sigma_m();
    if (i == 40) after_a_turn_m = last_m;
  }
  EXPECT_GT(last_m, 0);
  EXPECT_LT(last_m, 1.5 * after_a_turn_m);
}

TEST(MapCertainty, GroundThatIsNotTrackedAgainstDoesNotBoundUntilALoopIsClosed) {
  Walk walk;
  const auto lap = [&walk](int from_deg, int to_deg) {
    double last_m = 0;
    for (int turn_deg = from_deg; turn_deg <= to_deg; turn_deg += 20)
      last_m = walk.see(at(0, 0, turn_deg)).position_sigma_m();
    return last_m;
  };
  lap(0, 160);
  walk.submaps.push_back(Rigid3{});
  walk.is_active = {true, true};
  walk.current = 1;
  lap(180, 220);
  walk.is_active = {false, true};
  const double open_m = lap(240, 360);
  walk.is_active = {true, true};
  ++walk.closures;
  const double closed_m = lap(370, 370);
  EXPECT_GT(open_m, 3 * closed_m);
}

TEST(MapCertainty, AWallHoldsTheCameraAcrossItOnly) {
  frame::CoarseView wall = box_seen(at(0, 0, 0), 0);
  for (std::size_t i = 0; i < wall.size(); ++i) {
    wall.depth_m[i] = 2;
    wall.normals[i] = Eigen::Vector3f::UnitZ();
  }
  Matrix6d step = 1e-8 * Matrix6d::Identity();
  step(0, 0) = 1e-4;  // hardly held along x
  MapCertainty certainty;
  const std::vector<Rigid3> submaps{Rigid3{}};
  PoseUncertainty last;
  for (int i = 0; i < 3; ++i)
    last = certainty.observe(wall, frame::CoarseMask(4800, 0), Rigid3{}, {step, i / 30.0},
                             {submaps, {true}, 0, 0});
  EXPECT_GT(std::abs(last.worst_direction().x()), 0.99);
  EXPECT_GT(last.position_sigma_m(), 0.009);
}

TEST(MapCertainty, FindsABentDepthWhileScanning) {
  for (const double bend : {0.0, 0.015}) {
    Walk walk(bend);
    for (int i = 0; i < 40; ++i)
      walk.see(at(0.5 * std::sin(0.35 * i), -0.8 * std::cos(0.2 * i), 60 * std::sin(0.27 * i)));
    const CalibrationDoubt doubt = walk.certainty.calibration();
    EXPECT_NEAR(doubt.bend, bend, 0.003);
    EXPECT_LT(doubt.deviation, 0.003);
    EXPECT_EQ(doubt.reason().empty(), bend == 0) << doubt.reason();
  }
}

TEST(MapCertainty, AfterTimeWithoutSightThePlaceIsInDoubtUntilEnoughOfItIsSeenAgain) {
  Walk walk;
  for (int turn_deg = 0; turn_deg <= 340; turn_deg += 20) walk.see(at(0, 0, turn_deg));
  const double known_m = walk.see(at(0.02, 0, 0)).position_sigma_m();
  walk.time_s += 3;
  const PoseUncertainty back = walk.see(at(0.02, 0, 0), {.gap = {.unseen_s = 3}});
  EXPECT_EQ(back.elsewhere_m, 3);
  EXPECT_GT(back.position_sigma_m(), 1);
  EXPECT_TRUE(walk.certainty.is_in_doubt({}));
  EXPECT_EQ(walk.see(at(0.02, 0, 90), {.is_distinctive = false}).elsewhere_m, 3)
      << "it recurs in the map";
  const PoseUncertainty settled = walk.see(at(0.02, 0, 0));
  EXPECT_EQ(settled.elsewhere_m, 0) << "nearly all of the room was seen since";
  EXPECT_NEAR(settled.position_sigma_m(), known_m, 0.3 * known_m);
  EXPECT_FALSE(walk.certainty.is_in_doubt({}));
}

TEST(MapCertainty, NewGroundDoesNotSettleTheDoubt) {
  Walk walk;
  for (int turn_deg = 0; turn_deg <= 80; turn_deg += 20) walk.see(at(0, 0, turn_deg));
  walk.see(at(0, 0, 130), {.gap = {.unseen_s = 3}});
  PoseUncertainty last;
  for (int turn_deg = 150; turn_deg <= 250; turn_deg += 20) last = walk.see(at(0, 0, turn_deg));
  EXPECT_EQ(last.elsewhere_m, 3);
  const double alone_m =
      std::sqrt(3) * walk.certainty.expected_error({walk.submaps, walk.is_active, 0, 0}).doubt_m;
  EXPECT_GT(alone_m, 0.5);
}

TEST(MapCertainty, GoesOnFromWhatWasSaved) {
  Walk before, after;
  for (int turn_deg = 0; turn_deg < 100; turn_deg += 20) before.see(at(0, 0, turn_deg));
  before.see(at(0, 0, 100), {.gap = {.unseen_s = 2}});
  ByteWriter bytes;
  before.certainty.save(bytes);
  const std::string saved = bytes.take();
  ByteReader reader(saved);
  after.certainty.restore(reader);
  EXPECT_TRUE(reader.ok() && reader.at_end());
  EXPECT_EQ(before.see(at(0, 0, 110)).second_moment, after.see(at(0, 0, 110)).second_moment);
  for (std::size_t size = 0; size < saved.size(); size += 997) {
    Walk cut;
    ByteReader short_reader(std::string_view(saved).substr(0, size));
    cut.certainty.restore(short_reader);
    EXPECT_FALSE(short_reader.ok()) << size;
  }
}

}  // namespace
}  // namespace hermite::track::map_certainty_test
