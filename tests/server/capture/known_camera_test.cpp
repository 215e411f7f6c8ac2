#include "server/capture/known_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/dataset/camera_file.h"
#include "core/output/ply.h"
#include "tests/support/temporary_folder.h"

namespace hermite::client::known_camera_test {
namespace {

using testing::HasSubstr;

Camera some_camera() {
  Camera camera{640, 480, 520, 521, 319, 240, 1000};
  camera.depth_correction.bend = 0.01;
  camera.deviations = {0.001, 0.0015, 0.003};
  return camera;
}

class KnownCamera : public testing::Test {
 protected:
  test::TemporaryFolder folder_;
  const std::string path_ = folder_.path() + "/kinect.json";
};

TEST_F(KnownCamera, IsThereForTheNextScan) {
  ASSERT_TRUE(known_camera_in(path_).ok());
  EXPECT_EQ(*known_camera_in(path_), std::nullopt);
  const std::string report =
      R"({"frames": 3, "known_camera": )" + dataset::format_camera_json({some_camera()}) + "}";
  ASSERT_TRUE(keep_known_camera(report, "a Kinect", path_).ok());
  EXPECT_EQ(*known_camera_in(path_), some_camera());
}

TEST_F(KnownCamera, IsOfOneDevice) {
  EXPECT_TRUE(check_device(path_, "a Kinect").ok()) << "there is no file yet";
  const std::string report =
      R"({"known_camera": )" + dataset::format_camera_json({some_camera()}) + "}";
  ASSERT_TRUE(keep_known_camera(report, "a Kinect", path_).ok());
  EXPECT_TRUE(check_device(path_, "a Kinect").ok());
  const Status other = check_device(path_, "an Xtion");
  ASSERT_FALSE(other.ok());
  EXPECT_THAT(other.error().message,
              testing::AllOf(HasSubstr(path_), HasSubstr("a Kinect"), HasSubstr("an Xtion")));
  ASSERT_TRUE(
      output::write_file_atomically(path_, dataset::format_camera_json({some_camera()})).ok());
  EXPECT_TRUE(check_device(path_, "an Xtion").ok()) << "a camera.json names no device";
}

TEST_F(KnownCamera, StaysWhereTheReportHasNone) {
  ASSERT_TRUE(
      output::write_file_atomically(path_, dataset::format_camera_json({some_camera()})).ok());
  for (const std::string report :
       {"", "7", R"({"frames": 3})", R"({"known_camera": 7})", R"({"known_camera": {"width": 1}})"})
    EXPECT_FALSE(keep_known_camera(report, "a Kinect", path_).ok()) << report;
  EXPECT_THAT(keep_known_camera("{}", "a Kinect", path_).error().message, HasSubstr("older"));
  EXPECT_EQ(*known_camera_in(path_), some_camera());
}

TEST_F(KnownCamera, AFileThatIsNoCameraIsAnErrorThatNamesIt) {
  ASSERT_TRUE(output::write_file_atomically(path_, R"({"width": 640})").ok());
  EXPECT_THAT(known_camera_in(path_).error().message,
              testing::AllOf(HasSubstr("kinect.json"), HasSubstr("height")));
  const std::string report =
      R"({"known_camera": )" + dataset::format_camera_json({some_camera()}) + "}";
  EXPECT_FALSE(keep_known_camera(report, "a Kinect", folder_.path() + "/missing/file.json").ok());
}

}  // namespace
}  // namespace hermite::client::known_camera_test
