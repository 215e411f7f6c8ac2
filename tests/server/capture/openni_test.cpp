// OpenNI2 with the virtual device that comes with it: 320x240, some pixels of depth. In a process of its own, as a user would have it.
#include "server/capture/openni.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "core/dataset/recording.h"
#include "tests/support/temporary_folder.h"

namespace hermite {
namespace {

using testing::HasSubstr;

int scan(const test::TemporaryFolder& folder, const std::string& arguments) {
  const std::string command = std::string("'") + HERMITE_CLIENT + "' scan --preflight 3 --frames 5 " + arguments + " --record '" +
                              folder / "log" + "' 2> '" + folder / "err" + "'";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

std::string words_of(const test::TemporaryFolder& folder) {
  std::ifstream file(folder / "err");
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

std::string camera_json(const test::TemporaryFolder& folder, int width) {
  std::ofstream(folder / "camera.json")
      << R"({"width": )" << width << R"(, "height": 240, "fx": 262, "fy": 262, "cx": 159.5, "cy": 119.5, "depth_units_per_metre": 1000})";
  return " --intrinsics '" + folder / "camera.json" + "'";
}

bool is_built_in(const test::TemporaryFolder& folder) {
  scan(folder, "--camera openni:Dummy");
  return words_of(folder).find("not in this build") == std::string::npos;
}

TEST(OpenNi, GivesFramesOfTheVirtualDeviceInOrder) {
  const test::TemporaryFolder folder;
  if (!is_built_in(folder)) GTEST_SKIP() << "built without OpenNI2 (Debian package libopenni2-dev)";
  ASSERT_EQ(scan(folder, "--camera openni:Dummy" + camera_json(folder, 320)), 0) << words_of(folder);
  const auto recorded = open_recording(folder / "log");
  ASSERT_TRUE(recorded.ok()) << recorded.error().message;
  ASSERT_EQ(recorded->sequence->frame_count(), 5);
  const auto frame = recorded->sequence->read(4);
  ASSERT_TRUE(frame.ok());
  EXPECT_EQ(frame->depth.width, 320);
  EXPECT_GT(frame->depth.pixels.size() - static_cast<std::size_t>(std::count(frame->depth.pixels.begin(), frame->depth.pixels.end(), 0)),
            300u);
  EXPECT_NEAR(recorded->sequence->frame_rate_hz(), 30, 1);
}

TEST(OpenNi, WhatCannotBeIsSaidInWords) {
  const test::TemporaryFolder folder;
  if (!is_built_in(folder)) GTEST_SKIP() << "built without OpenNI2 (Debian package libopenni2-dev)";
  EXPECT_THAT(words_of(folder), HasSubstr("give --intrinsics")) << "the virtual device has no field of view";
  EXPECT_EQ(scan(folder, "--camera openni:Dummy" + camera_json(folder, 319)), 1);
  EXPECT_THAT(words_of(folder), HasSubstr("319x240"));
  EXPECT_EQ(scan(folder, "--camera openni:nowhere"), 1);
  EXPECT_THAT(words_of(folder), HasSubstr("nowhere cannot be opened"));
  EXPECT_EQ(scan(folder, "--camera openni:98"), 1);
  EXPECT_THAT(words_of(folder), HasSubstr("there is no camera 98"));
}

}  // namespace
}  // namespace hermite
