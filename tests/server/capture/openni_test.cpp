// OpenNI2 with the virtual device that comes with it: 320x240, some pixels of depth.
#include "server/capture/openni.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>

#include "server/capture/camera_kinds.h"

// OpenNI2's drivers keep what they have until the process ends. Asked for by LeakSanitizer, where
// that is there.
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libOpenNI2\nleak:libPS1080\nleak:libPSLink\n";
}

namespace hermite::client::openni_test {
namespace {

using testing::HasSubstr;

const Camera kIntrinsics{320, 240, 262, 262, 159.5, 119.5, 1000};
const char* const kNotBuiltIn = "built without OpenNI2 (Debian package libopenni2-dev)";

bool is_built_in() {
  for (const CameraKind& kind : camera_kinds())
    if (std::string(kind.name) == "openni") return kind.open != nullptr;
  return false;
}

// The virtual device of Debian's OpenNI2 crashes some time after it was closed: whoever opens it
// does so in a process that ends then. The exit status of `what`; -1 for a crash.
int in_a_process(const std::function<int()>& what) {
  const pid_t child = fork();
  if (child == 0) std::_Exit(what());
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status)
                                                                               : -1;
}

constexpr int kNoFrames = 99;

// 0: two frames of the virtual device, one after the other, are as they should be; else which line
// says what is not.
int look_at_two_frames() {
  const auto camera = open_camera("openni:Dummy", kIntrinsics);
  if (!camera.ok() || (*camera)->description().camera != kIntrinsics ||
      (*camera)->description().frame_rate_hz != 30)
    return 1;
  std::vector<frame::RgbdFrame> frames;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  while (frames.size() < 2 && std::chrono::steady_clock::now() < deadline) {
    auto frame = (*camera)->next(std::chrono::milliseconds(100));
    if (!frame.ok()) return 2;
    if (*frame) frames.push_back(**std::move(frame));
  }
  if (frames.size() < 2) return kNoFrames;
  const double step_s = frames[1].timestamp_s - frames[0].timestamp_s;
  // The device counts in steps of 33 ms.
  if (step_s <= 0 || std::abs(std::remainder(step_s, 0.033)) > 1e-6) return 3;
  if (frames[0].depth.width != 320 || frames[0].color.height != 240) return 4;
  const auto& pixels = frames[1].depth.pixels;
  return std::count_if(pixels.begin(), pixels.end(),
                       [](std::uint16_t depth) { return depth > 0; }) > 300
             ? 0
             : 5;
}

std::string refusal(const std::string& wish, const std::optional<Camera>& intrinsics) {
  const auto camera = open_camera(wish, intrinsics);
  return camera.ok() ? "" : camera.error().message;
}

TEST(OpenNi, GivesFramesOfTheVirtualDeviceInOrder) {
  if (!is_built_in()) GTEST_SKIP() << kNotBuiltIn;
  // Its two streams have a thread and a clock each, and lose each other on a busy machine.
  int result = kNoFrames;
  for (int attempt = 0; attempt < 20 && result == kNoFrames; ++attempt)
    result = in_a_process(look_at_two_frames);
  EXPECT_EQ(result, 0);
}

TEST(OpenNi, WhatCannotBeIsSaidInAMessage) {
  if (!is_built_in()) GTEST_SKIP() << kNotBuiltIn;
  const auto refuses = [](const std::optional<Camera>& intrinsics, const char* message) {
    return in_a_process([&] {
             return refusal("openni:Dummy", intrinsics).find(message) == std::string::npos ? 1 : 0;
           }) == 0;
  };
  EXPECT_TRUE(refuses(std::nullopt, "give --intrinsics"))
      << "the virtual device has no field of view";
  Camera narrow = kIntrinsics;
  narrow.width = 319;
  EXPECT_TRUE(refuses(narrow, "319x240"));
  EXPECT_THAT(refusal("openni:nowhere", std::nullopt), HasSubstr("nowhere cannot be opened"));
  EXPECT_THAT(refusal("openni:98", std::nullopt), HasSubstr("there is no camera 98"));
}

}  // namespace
}  // namespace hermite::client::openni_test
