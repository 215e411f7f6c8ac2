#include "server/capture/camera_kinds.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hermite::client::camera_kinds_test {
namespace {

using testing::HasSubstr;

std::string refusal(const std::string& wish,
                    const std::optional<Camera>& intrinsics = std::nullopt) {
  const auto camera = open_camera(wish, intrinsics);
  return camera.ok() ? "" : camera.error().message;
}

TEST(CameraKinds, EveryKindHasALineInTheListWhetherBuiltInOrNot) {
  const std::string list = list_cameras();
  for (const CameraKind& kind : camera_kinds()) {
    EXPECT_THAT(list, HasSubstr(kind.name));
    EXPECT_EQ(kind.find == nullptr, kind.open == nullptr);
    if (!kind.open) {
      EXPECT_THAT(list, HasSubstr("not in this build"));
      EXPECT_THAT(refusal(kind.name), HasSubstr("not in this build"));
    }
  }
}

TEST(CameraKinds, WhatIsNotKnownIsRefusedWithWhatIs) {
  EXPECT_THAT(refusal("webcam"), testing::AllOf(HasSubstr("\"webcam\" is not known"),
                                                HasSubstr("kinect"), HasSubstr("recording:")));
  for (const char* wish : {"kinect:", "kinect:0", "kinect:-1", "kinect:100", "kinect:1x",
                           "kinect:99999999999999999999"})
    EXPECT_THAT(refusal(wish), HasSubstr("a number from 1 to 99")) << wish;
  EXPECT_THAT(refusal("recording:/nowhere"), HasSubstr("/nowhere"));
}

TEST(CameraKinds, IntrinsicsAreLookedAtBeforeTheCamera) {
  Camera camera{640, 480, 525, 525, 319.5, 239.5, 1000};
  camera.fx = -1;
  EXPECT_THAT(refusal("kinect", camera), HasSubstr("camera.fx"));
}

TEST(CameraKinds, ARecordingIsPlayedWithItsOwnOrTheGivenIntrinsics) {
  const auto own = open_camera("recording:synthetic:frames=2,width=96,height=72", std::nullopt);
  ASSERT_TRUE(own.ok()) << own.error().message;
  EXPECT_EQ((*own)->description().camera.width, 96);
}

}  // namespace
}  // namespace hermite::client::camera_kinds_test
