#include "core/pipeline/camera_doubts.h"

#include <gtest/gtest.h>

namespace hermite::pipeline::camera_doubts_test {
namespace {

using calibrate::kFitting;

TEST(CameraDoubts, AnEarlierCalibrationIsNotBelievedToBetterThanACameraThatFits) {
  const track::CameraDoubts precise = believed({.bend = 1e-6, .focal = 1e-6, .k1 = 1e-6});
  EXPECT_EQ(precise[track::kBendDoubt], kFitting.bend);
  EXPECT_EQ(precise[track::kFocalDoubt], kFitting.focal);
  EXPECT_EQ(precise[track::kRadialDoubt], kFitting.k1);
  EXPECT_EQ(believed({.bend = 0.02})[track::kBendDoubt], 0.02);
  EXPECT_EQ(believed({}), track::CameraDoubts::Zero()) << "nothing is known";
}

TEST(CameraDoubts, WhatIsKnownOfACameraIsAValidPartOfIt) {
  Camera camera{640, 480, 525, 525, 319.5, 239.5};
  camera.deviations = deviations_of({0.2, 0.004, 0.003});
  EXPECT_TRUE(validate(camera).ok());
  EXPECT_EQ(camera.deviations, (CameraDeviations{kMaxCameraDeviation, 0.004, 0.003}));
}

}  // namespace
}  // namespace hermite::pipeline::camera_doubts_test
