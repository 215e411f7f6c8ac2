// .oni files that Debian's OpenNI2 wrote, of its virtual device: what the importer is to read is
// not only what we think the format is.
#include <gtest/gtest.h>

#if HERMITE_WITH_OPENNI2
#include <OniCAPI.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <optional>

#include "core/dataset/recording.h"
#include "tests/core/dataset/temp_folder.h"

namespace hermite::client::openni_recorder_test {
namespace {

constexpr int kWidth = 320, kHeight = 240;  // of the virtual device
constexpr int kEnough = 12;                 // images of each stream
// Limit for both: the streams have a thread each, and one may lag on a busy machine.
constexpr int kMaxImages = 300;
const Camera kIntrinsics{kWidth, kHeight, 262, 262, 159.5, 119.5, 1000};

// What the device gave while it was recorded, kept beside the recording by number of frame.
std::string raw_name(int stream, int number) {
  return (stream == 0 ? "depth-" : "color-") + std::to_string(number) + ".raw";
}

bool check(OniStatus status) { return status == ONI_STATUS_OK; }

// 0: recorded.
int record(const dataset::TempFolder& folder, bool lossy) {
  OniDeviceHandle device = nullptr;
  OniRecorderHandle recorder = nullptr;
  OniStreamHandle streams[2] = {nullptr, nullptr};
  if (!check(oniInitialize(ONI_API_VERSION)) || !check(oniDeviceOpen("Dummy", &device))) return 1;
  if (!check(oniCreateRecorder(folder.path("a.oni").c_str(), &recorder))) return 2;
  for (const int i : {0, 1})
    if (!check(oniDeviceCreateStream(device, i == 0 ? ONI_SENSOR_DEPTH : ONI_SENSOR_COLOR,
                                     &streams[i])) ||
        !check(oniRecorderAttachStream(recorder, streams[i], lossy)))
      return 3;
  if (!check(oniRecorderStart(recorder))) return 4;
  for (OniStreamHandle stream : streams)
    if (!check(oniStreamStart(stream))) return 5;
  int seen[2] = {0, 0};
  for (int i = 0; i < kMaxImages && std::min(seen[0], seen[1]) < kEnough; ++i) {
    int ready = 0;
    OniFrame* frame = nullptr;
    if (!check(oniWaitForAnyStream(streams, 2, &ready, 2000)) ||
        !check(oniStreamReadFrame(streams[ready], &frame)))
      return 6;
    ++seen[ready];
    const auto* const data = static_cast<const std::uint8_t*>(frame->data);
    folder.write(raw_name(ready, frame->frameIndex),
                 std::vector<std::uint8_t>(data, data + frame->dataSize));
    oniFrameRelease(frame);
  }
  oniRecorderStop(recorder);
  return check(oniRecorderDestroy(&recorder)) ? 0 : 7;
}

// Recording takes place in a process of its own: the virtual device crashes some time after it was
// closed, and the recorder may lock itself out when it ends (Debian's 2.2.0.33).
constexpr unsigned kLongest_s = 10;

int record_in_a_process(const dataset::TempFolder& folder, bool lossy) {
  const pid_t child = fork();
  if (child == 0) {
    alarm(kLongest_s);
    std::_Exit(record(folder, lossy));
  }
  int status = 0;
  return child > 0 && waitpid(child, &status, 0) == child && WIFEXITED(status) ? WEXITSTATUS(status)
                                                                               : -1;
}

// Which of the kept images is this one? None of them: empty.
std::string name_of_same(const dataset::TempFolder& folder, int stream, const void* pixels,
                         std::size_t byte_count) {
  for (int number = 1; number <= kMaxImages; ++number) {
    std::ifstream file(folder.path(raw_name(stream, number)), std::ios::binary);
    if (!file) continue;
    std::string kept(byte_count + 1, '\0');
    file.read(kept.data(), static_cast<std::streamsize>(kept.size()));
    if (file.gcount() == static_cast<std::streamsize>(byte_count) &&
        std::memcmp(kept.data(), pixels, byte_count) == 0)
      return raw_name(stream, number);
  }
  return "";
}

class OpenNiRecorder : public testing::TestWithParam<bool> {};

TEST_P(OpenNiRecorder, WhatItWroteIsReadToTheBit) {
  const bool lossy = GetParam();
  std::optional<dataset::TempFolder> made;
  int result = -1;
  for (int attempt = 0; attempt < 5 && result != 0; ++attempt)
    result = record_in_a_process(made.emplace(), lossy);
  ASSERT_EQ(result, 0);
  const dataset::TempFolder& folder = *made;
  const auto recording = dataset::open_recording(folder.path("a.oni"), kIntrinsics);
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  const dataset::Sequence& found = *recording->sequence;
  EXPECT_EQ(found.format(), "oni");
  EXPECT_EQ(found.frame_rate_hz(), 30);
  EXPECT_GE(found.frame_count(), 5);
  for (const std::string& doubt : recording->doubts)
    EXPECT_EQ(doubt.find("cut"), std::string::npos) << doubt;
  int seen_depth = 0, seen_color = 0;
  for (std::int64_t i = 0; i < found.frame_count(); ++i) {
    const auto recorded = found.read(i);
    ASSERT_TRUE(recorded.ok()) << recorded.error().message;
    const auto frame = dataset::decode_frame(*recorded);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    if (i > 0) {
      EXPECT_GT(found.timestamp_s(i), found.timestamp_s(i - 1));
    }
    // Not every frame that was recorded was also given to us.
    seen_depth +=
        name_of_same(folder, 0, frame->depth.pixels.data(), 2 * frame->depth.pixels.size()).empty()
            ? 0
            : 1;
    seen_color +=
        name_of_same(folder, 1, frame->color.pixels.data(), 3 * frame->color.pixels.size()).empty()
            ? 0
            : 1;
  }
  EXPECT_GE(seen_depth, 5);
  if (!lossy) {
    EXPECT_GE(seen_color, 5);
  }
}

INSTANTIATE_TEST_SUITE_P(Both, OpenNiRecorder, testing::Bool(), [](const auto& info) {
  return info.param ? "JpegColour" : "PlainColour";
});

}  // namespace
}  // namespace hermite::client::openni_recorder_test

#else

TEST(OpenNiRecorder, WhatItWroteIsReadToTheBit) {
  GTEST_SKIP() << "built without OpenNI2 (Debian package libopenni2-dev)";
}

#endif
