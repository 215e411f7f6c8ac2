#include "core/pipeline/camera_correction.h"

#include <gtest/gtest.h>

namespace hermite::pipeline {
namespace {

TEST(CameraCorrection, NamesEachParameterThatDiffers) {
  const Camera given{640, 480, 500, 500, 320, 240, 1000};
  Camera corrected = given;
  corrected.fx = 490;
  EXPECT_EQ(camera_correction_message(given, corrected),
            "the camera's calibration was off and is corrected: focal length by -2.00 %");
  corrected.distortion.k1 = -0.0504;
  corrected.depth_correction.bend = 0.0125;
  corrected.timing = {0.033, 0, -0.0104};
  EXPECT_EQ(camera_correction_message(given, corrected),
            "the camera's calibration was off and is corrected: focal length by -2.00 %, "
            "distortion of the lens (k1) by -0.050, depth in the corners of the image by +1.25 %, "
            "readout of depth by +33.0 ms, delay of colour by -10.4 ms");
}

}  // namespace
}  // namespace hermite::pipeline
