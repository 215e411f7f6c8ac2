// The real client with the real libfreenect's interface, behind which fakenect plays what this test
// has written: no Kinect is needed.
#include "server/capture/kinect.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "core/dataset/accelerometer.h"
#include "core/dataset/recording.h"
#include "core/source/open_sequence.h"
#include "server/capture/camera_kinds.h"
#include "server/client/stream.h"
#include "tests/support/data_folder.h"
#include "tests/support/fakenect_dump.h"
#include "tests/support/running_server.h"
#include "tests/support/temporary_folder.h"

namespace hermite::client::kinect_test {
namespace {

using Json = nlohmann::json;
using testing::HasSubstr;

constexpr double kRate_hz = 30;
constexpr int kPreflight = 3;

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// A dump of the first frames of a sequence of 640x480 in millimetres or other units. Colour comes 5
// ms after depth; the colour image of frame `without_color` is not there.
std::vector<frame::RgbdFrame> write_dump(const std::string& folder,
                                         const dataset::Sequence& sequence, int count,
                                         int without_color = -1) {
  std::filesystem::create_directory(folder);
  test::FakenectDump dump(folder);
  std::vector<frame::RgbdFrame> frames;
  for (int i = 0; i < count; ++i) {
    frame::RgbdFrame frame = *dataset::decode_frame(*sequence.read(i));
    for (std::uint16_t& depth : frame.depth.pixels) {
      const double depth_mm =
          depth == 65535 ? 0 : 1000 * depth / sequence.camera().depth_units_per_metre;
      depth = static_cast<std::uint16_t>(std::lround(depth_mm));
    }
    frame.timestamp_s = i / kRate_hz;
    if (frame.acceleration_m_s2) {
      const Eigen::Vector3d counts = dataset::camera_from_kinect_accelerometer().transpose() *
                                     *frame.acceleration_m_s2 / 9.80665 * 819;
      dump.add_acceleration(frame.timestamp_s, counts.array().round().cast<std::int16_t>());
    }
    dump.add_depth(frame.timestamp_s, frame.depth);
    if (i != without_color) dump.add_color(frame.timestamp_s + 0.005, frame.color);
    frames.push_back(std::move(frame));
  }
  return frames;
}

// Exit status of `hermite-client scan` with a Kinect that is that dump. What it says is in
// folder/out and folder/err.
int scan(const test::TemporaryFolder& folder, const std::string& dump,
         const std::string& arguments) {
  // Leaks are allowed, since fakenect does not free everything.
  const std::string command = std::string("LD_LIBRARY_PATH=") + HERMITE_FAKENECT_FOLDER +
                              " FAKENECT_PATH='" + dump + "' ASAN_OPTIONS=detect_leaks=0 '" +
                              HERMITE_CLIENT + "' scan " + arguments + " > '" + folder / "out" +
                              "' 2> '" + folder / "err" + "'";
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

bool can_play() {
  return camera_kinds().front().open &&
         std::filesystem::exists(std::string(HERMITE_FAKENECT_FOLDER) + "/libfreenect.so.0.5");
}
const char* const kCannotPlay =
    "built without libfreenect, or no fakenect (Debian packages libfreenect-dev, libfreenect-bin)";

// Every depth to the nearest step of the sensor; beyond 4 m, where a step is 5 cm, nothing is
// looked at.
void expect_same_depth(const DepthImage& seen, const DepthImage& dumped) {
  ASSERT_EQ(seen.pixels.size(), dumped.pixels.size());
  for (std::size_t k = 0; k < seen.pixels.size(); ++k) {
    const double from = dumped.pixels[k];
    if (from > 4000) continue;
    const double half_step_mm = 0.5 * 0.0030711016e-3 * from * from + 1;
    if (from < 400)
      ASSERT_EQ(seen.pixels[k], 0) << "pixel " << k;
    else
      ASSERT_NEAR(seen.pixels[k], from, half_step_mm) << "pixel " << k;
  }
}

double mean_difference(const ColorImage& a, const ColorImage& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.pixels.size(); ++k) sum += std::abs(a.pixels[k].g - b.pixels[k].g);
  return sum / static_cast<double>(a.pixels.size());
}

TEST(Kinect, GivesWhatWasDumpedPairedByTimeAndInOrder) {
  if (!can_play()) GTEST_SKIP() << kCannotPlay;
  const test::TemporaryFolder folder;
  const auto room =
      *source::open_sequence("synthetic:frames=10,width=640,height=480+accelerometer=noise_m_s2=1");
  constexpr int kWithoutColor = 6;
  const std::vector<frame::RgbdFrame> dumped =
      write_dump(folder / "dump", *room, 10, kWithoutColor);
  ASSERT_EQ(scan(folder, folder / "dump",
                 "--camera kinect --preflight 3 --frames 6 --record '" + folder / "log" + "'"),
            0)
      << text_of(folder / "err");
  const auto recorded = dataset::open_recording(folder / "log");
  ASSERT_TRUE(recorded.ok()) << recorded.error().message;
  EXPECT_TRUE(recorded->doubts.empty()) << recorded->doubts.front();
  const dataset::Sequence& log = *recorded->sequence;
  EXPECT_TRUE(log.camera().color) << "fakenect does not register";
  ASSERT_EQ(log.frame_count(), 6);
  int index = kPreflight;
  for (std::int64_t i = 0; i < log.frame_count(); ++i, ++index) {
    if (index == kWithoutColor) ++index;
    const auto frame = dataset::decode_frame(*log.read(i));
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    const frame::RgbdFrame& expected = dumped[static_cast<std::size_t>(index)];
    EXPECT_NEAR(frame->timestamp_s, expected.timestamp_s, 1e-6) << "the ticks ran over on the way";
    expect_same_depth(frame->depth, expected.depth);
    EXPECT_LT(mean_difference(frame->color, expected.color), 3)
        << "frame " << i << ": it is a JPEG now, but that image";
    ASSERT_TRUE(frame->acceleration_m_s2.has_value());
    EXPECT_LT((*frame->acceleration_m_s2 - *expected.acceleration_m_s2).norm(), 0.011)
        << "half a count of each axis";
  }
}

TEST(Kinect, IsListedAndItsAbsenceIsSaid) {
  // OpenNI2's drivers, and fakenect below, do not free everything.
  EXPECT_EQ(std::system((std::string("ASAN_OPTIONS=detect_leaks=0 '") + HERMITE_CLIENT +
                         "' scan --list > /dev/null")
                            .c_str()),
            0);
  if (!can_play()) GTEST_SKIP() << kCannotPlay;
  const test::TemporaryFolder folder;
  write_dump(folder / "dump", **source::open_sequence("synthetic:frames=1,width=640,height=480"),
             1);
  EXPECT_EQ(scan(folder, folder / "dump", "--list"), 0);
  EXPECT_THAT(text_of(folder / "out"), HasSubstr("kinect:1  Kinect v1 (1)"));
  EXPECT_EQ(scan(folder, folder / "dump", "--camera kinect:2 --record '" + folder / "log" + "'"),
            1);
  EXPECT_THAT(text_of(folder / "err"), HasSubstr("there is no Kinect v1 (2): 1 are attached"));
}

// From end to end: redkitchen through fakenect, libfreenect's interface, scan and the server,
// against the same frames from the file.
TEST(Kinect, AScanGivesTheCloudOfItsRecordingStreamedFromFile) {
  const auto data = test::data_folder("redkitchen");
  if (!data) GTEST_SKIP() << test::skip_message("redkitchen");
  if (!can_play()) GTEST_SKIP() << kCannotPlay;
  const test::TemporaryFolder folder;
  const auto kitchen = source::open_sequence(data->string());
  ASSERT_TRUE(kitchen.ok()) << kitchen.error().message;
  constexpr int kFrames = 6;
  write_dump(folder / "dump", **kitchen, kPreflight + kFrames + 1);
  test::RunningServer server(test::test_options(folder / "data"));
  const std::string address =
      "http://127.0.0.1:" + std::to_string(server.port()) + "/#token=" + server.token();
  ASSERT_EQ(scan(folder, folder / "dump",
                 "--camera kinect --preflight 3 --frames " + std::to_string(kFrames) +
                     " --set output.unstable=true --record '" + folder / "log" + "' --server '" +
                     address + "' --report '" + folder / "report.json" + "'"),
            0)
      << text_of(folder / "err");
  const Json scanned = Json::parse(text_of(folder / "report.json"));
  EXPECT_EQ(scanned["frames"], kFrames);
  EXPECT_EQ(scanned["tracked_frames"], kFrames);

  const auto recorded = source::open_sequence(folder / "log");
  ASSERT_TRUE(recorded.ok()) << recorded.error().message;
  StreamRequest request;
  request.server = {"127.0.0.1", static_cast<std::uint16_t>(server.port()), server.token()};
  request.settings = {{"output.unstable", "true"}};
  const auto streamed = stream_sequence(**recorded, {0, kFrames}, request, {});
  ASSERT_TRUE(streamed.ok()) << streamed.error().message;
  const Json expected = Json::parse(streamed->report_json);
  EXPECT_EQ(scanned["cloud_sha256"], expected["cloud_sha256"]);
  EXPECT_EQ(scanned["trajectory_sha256"], expected["trajectory_sha256"]);
}

}  // namespace
}  // namespace hermite::client::kinect_test
