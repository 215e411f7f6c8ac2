#include "core/raw/raw_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "tests/support/file_bytes.h"
#include "tests/support/temporary_folder.h"

namespace hermite {
namespace {

using testing::HasSubstr;

constexpr std::size_t kHeaderBytes = 104;

const Camera kCamera{96, 72, 90.5, 91.25, 47.5, 35.75, 5000, {0.01, -0.02, 0.003, -0.004, 0.005}};

frame::RgbdFrame frame_number(int number) {
  frame::RgbdFrame frame{1e9 + 0.1 * number, DepthImage(kCamera.width, kCamera.height),
                         ColorImage(kCamera.width, kCamera.height)};
  for (std::size_t i = 0; i < frame.depth.pixels.size(); ++i) {
    frame.depth.pixels[i] =
        static_cast<std::uint16_t>(7 * i + 1000 * static_cast<std::size_t>(number));
    frame.color.pixels[i] = {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8),
                             static_cast<std::uint8_t>(number)};
  }
  return frame;
}

class RawFramesTest : public testing::Test {
 protected:
  RawFramesTest() : path(folder / "frames.raw") {}

  void write(int frame_count, const Camera& camera = kCamera) {
    Result<RawFrameWriter> writer = RawFrameWriter::create(path, camera, frame_count);
    ASSERT_TRUE(writer.ok()) << writer.error().message;
    for (int i = 0; i < frame_count; ++i) ASSERT_TRUE(writer->append(frame_number(i)).ok());
    ASSERT_TRUE(writer->finish().ok());
  }
  void expect_one_frame_comes_back(const Camera& camera) {
    write(1, camera);
    Result<RawFrameReader> reader = RawFrameReader::open(path);
    ASSERT_TRUE(reader.ok()) << reader.error().message;
    EXPECT_EQ(reader->camera(), camera);
    EXPECT_EQ(reader->read(0)->color, frame_number(0).color);
  }
  void put(const std::vector<std::uint8_t>& bytes) {
    std::ofstream(path, std::ios::binary | std::ios::trunc)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
  }
  // What open() says of a file of three frames with `value` written over its bytes from `at` on.
  template <class Value>
  std::string message_after(std::size_t at, Value value) {
    write(3);
    std::vector<std::uint8_t> bytes = test::file_bytes(path);
    std::memcpy(bytes.data() + at, &value, sizeof value);
    put(bytes);
    const Result<RawFrameReader> reader = RawFrameReader::open(path);
    if (reader.ok()) return "accepted";
    EXPECT_EQ(reader.error().code, ErrorCode::kCorruptData);
    return reader.error().message;
  }

  const test::TemporaryFolder folder;
  const std::string path;
};

TEST_F(RawFramesTest, ComeBackAsTheyWentInInAnyOrder) {
  write(3);
  Result<RawFrameReader> reader = RawFrameReader::open(path);
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  EXPECT_EQ(reader->camera(), kCamera);
  ASSERT_EQ(reader->frame_count(), 3);
  for (const int index : {0, 1, 2, 1, 0}) {
    const Result<frame::RgbdFrame> frame = reader->read(index);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    const frame::RgbdFrame expected = frame_number(index);
    EXPECT_EQ(frame->timestamp_s, expected.timestamp_s);
    EXPECT_EQ(frame->depth, expected.depth);
    EXPECT_EQ(frame->color, expected.color);
  }
}

TEST_F(RawFramesTest, LieInTheFileAsDocumented) {
  write(1);
  const std::vector<std::uint8_t> bytes = test::file_bytes(path);
  const frame::RgbdFrame frame = frame_number(0);
  ASSERT_EQ(bytes.size(), kHeaderBytes + 8 + frame.depth.pixels.size() * 5);
  EXPECT_EQ(std::string(bytes.begin(), bytes.begin() + 8), "HRMFRAME");
  EXPECT_EQ(std::vector<std::uint8_t>(bytes.begin() + 8, bytes.begin() + 24),
            (std::vector<std::uint8_t>{1, 0, 0, 0, 96, 0, 0, 0, 72, 0, 0, 0, 1, 0, 0, 0}));
  double cy = 0;
  std::memcpy(&cy, &bytes[24 + 3 * 8], sizeof cy);
  EXPECT_EQ(cy, kCamera.cy);
  const std::size_t second_depth = kHeaderBytes + 8 + 2;
  EXPECT_EQ(bytes[second_depth] | bytes[second_depth + 1] << 8, frame.depth.pixels[1]);
  EXPECT_EQ(bytes[kHeaderBytes + 8 + frame.depth.pixels.size() * 2 + 3 * 300 + 1],
            frame.color.pixels[300].g);
}

TEST_F(RawFramesTest, AFileCutAnywhereIsRefused) {
  write(3);
  const std::vector<std::uint8_t> whole = test::file_bytes(path);
  for (const std::size_t size :
       {std::size_t{0}, std::size_t{1}, std::size_t{8}, std::size_t{20}, kHeaderBytes - 1,
        kHeaderBytes, kHeaderBytes + 8, whole.size() / 2, whole.size() - 1}) {
    put({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)});
    const Result<RawFrameReader> reader = RawFrameReader::open(path);
    ASSERT_FALSE(reader.ok()) << size;
    EXPECT_EQ(reader.error().code, ErrorCode::kCorruptData) << size;
    EXPECT_THAT(reader.error().message, HasSubstr(std::to_string(size) + " bytes"));
  }
  std::vector<std::uint8_t> longer = whole;
  longer.push_back(0);
  put(longer);
  EXPECT_FALSE(RawFrameReader::open(path).ok());
}

TEST_F(RawFramesTest, AWrongHeaderIsRefusedByFieldAndLimit) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message_after(8, std::uint32_t{1}), "accepted") << "nothing changed";
  EXPECT_THAT(message_after(0, 'X'), HasSubstr("HRMFRAME"));
  EXPECT_THAT(message_after(8, std::uint32_t{9}),
              HasSubstr("version 9, this program reads versions 1 to 8"));
  EXPECT_THAT(message_after(8, std::uint32_t{2}), HasSubstr("camera.color.f"))
      << "frames are no colour camera";
  EXPECT_THAT(message_after(12, std::uint32_t{0}), HasSubstr("camera.width is 0"));
  EXPECT_THAT(message_after(12, std::uint32_t{4096}), HasSubstr("2048"));
  EXPECT_THAT(message_after(16, ~std::uint32_t{0}), HasSubstr("camera.height"));
  EXPECT_THAT(message_after(12, std::uint32_t{97}), HasSubstr("cut short"));
  EXPECT_THAT(message_after(20, std::uint32_t{0}),
              HasSubstr("frame_count is 0, allowed is 1 to 1000000"));
  EXPECT_THAT(message_after(20, ~std::uint32_t{0}), HasSubstr("frame_count is 4294967295"));
  EXPECT_THAT(message_after(20, std::uint32_t{4}), HasSubstr("cut short"));
  EXPECT_THAT(message_after(24, nan), HasSubstr("camera.fx"));
  EXPECT_THAT(message_after(32, -90.0), HasSubstr("camera.fy"));
  EXPECT_THAT(message_after(56, 0.0), HasSubstr("camera.depth_units_per_metre"));
  EXPECT_THAT(message_after(64, 1e30), HasSubstr("camera.distortion"));
  EXPECT_THAT(message_after(96, nan), HasSubstr("camera.distortion"));
}

TEST_F(RawFramesTest, TheColourCameraComesBackBehindALongerHeader) {
  Camera camera = kCamera;
  camera.color =
      ColorCamera{80.5,
                  81,
                  48,
                  36,
                  {0.1, -0.2, 0.003, -0.004, 0.05},
                  {Eigen::Quaterniond(1, 0.01, -0.02, 0.03).normalized(), {-0.025, 0.001, 0.002}}};
  Result<RawFrameWriter> writer = RawFrameWriter::create(path, camera, 2);
  ASSERT_TRUE(writer.ok()) << writer.error().message;
  for (int i = 0; i < 2; ++i) ASSERT_TRUE(writer->append(frame_number(i)).ok());
  ASSERT_TRUE(writer->finish().ok());
  Result<RawFrameReader> reader = RawFrameReader::open(path);
  ASSERT_TRUE(reader.ok()) << reader.error().message;
  EXPECT_EQ(reader->camera(), camera);
  EXPECT_EQ(reader->read(1)->color, frame_number(1).color);

  std::vector<std::uint8_t> bytes = test::file_bytes(path);
  EXPECT_EQ(bytes[8], 2);
  EXPECT_EQ(bytes.size(),
            kHeaderBytes + 16 * 8 + 2 * (8 + frame_number(0).depth.pixels.size() * 5));
  put({bytes.begin(), bytes.begin() + kHeaderBytes + 20});
  EXPECT_THAT(RawFrameReader::open(path).error().message, HasSubstr("cut in the colour camera"));
  const double wide_m = 3;
  std::memcpy(&bytes[kHeaderBytes + 13 * 8], &wide_m, sizeof wide_m);
  put(bytes);
  EXPECT_THAT(RawFrameReader::open(path).error().message,
              HasSubstr("camera.color.color_from_depth.translation"));
}

TEST_F(RawFramesTest, TheCorrectionOfDepthComesBackBehindALongerHeader) {
  for (const bool has_color : {false, true}) {
    Camera camera = kCamera;
    if (has_color) camera.color = ColorCamera{80.5, 81, 48, 36, {}, {}};
    camera.depth_correction = {-0.015, 0.02};
    expect_one_frame_comes_back(camera);
    const std::vector<std::uint8_t> bytes = test::file_bytes(path);
    EXPECT_EQ(bytes[8], has_color ? 4 : 3);
    put({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(
                                            kHeaderBytes + (has_color ? 16 * 8 : 0) + 12)});
    EXPECT_THAT(RawFrameReader::open(path).error().message,
                HasSubstr("cut in the correction of depth"));
  }
}

TEST_F(RawFramesTest, TheTimingOfRowsComesBackBehindALongerHeader) {
  Camera camera = kCamera;
  camera.depth_correction = {-0.015, 0.02};
  camera.timing = {0.033, 0.03, -0.01};
  expect_one_frame_comes_back(camera);
  const std::vector<std::uint8_t> bytes = test::file_bytes(path);
  EXPECT_EQ(bytes[8], 1 + 2 + 4);
  put({bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(kHeaderBytes + 2 * 8 + 12)});
  EXPECT_THAT(RawFrameReader::open(path).error().message,
              HasSubstr("cut in the timing of the images"));
}

TEST_F(RawFramesTest, ATimeStampThatIsNoNumberIsAnErrorOfItsFrame) {
  EXPECT_EQ(message_after(kHeaderBytes, std::numeric_limits<double>::infinity()), "accepted");
  Result<RawFrameReader> reader = RawFrameReader::open(path);
  ASSERT_TRUE(reader.ok());
  EXPECT_THAT(reader->read(0).error().message, HasSubstr("frame 0"));
  EXPECT_TRUE(reader->read(1).ok());
}

TEST_F(RawFramesTest, WhatIsNoFileIsNotFound) {
  for (const std::string& absent : {folder / "absent", folder.path()}) {
    const Result<RawFrameReader> reader = RawFrameReader::open(absent);
    ASSERT_FALSE(reader.ok());
    EXPECT_EQ(reader.error().code, ErrorCode::kNotFound);
    EXPECT_THAT(reader.error().message, HasSubstr(absent));
  }
}

TEST_F(RawFramesTest, TheWriterKeepsItsPromise) {
  EXPECT_EQ(RawFrameWriter::create(folder / "no/folder", kCamera, 1).error().code, ErrorCode::kIo);
  EXPECT_EQ(RawFrameWriter::create(path, kCamera, 0).error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(RawFrameWriter::create(path, Camera{}, 1).error().code, ErrorCode::kInvalidArgument);
  Result<RawFrameWriter> writer = RawFrameWriter::create(path, kCamera, 1);
  ASSERT_TRUE(writer.ok());
  EXPECT_EQ(writer->finish().error().code, ErrorCode::kInvalidArgument) << "no frame yet";
  EXPECT_EQ(writer->append({0, DepthImage(8, 8), ColorImage(8, 8)}).error().code,
            ErrorCode::kInvalidArgument);
  EXPECT_TRUE(writer->append(frame_number(0)).ok());
  EXPECT_EQ(writer->append(frame_number(1)).error().code, ErrorCode::kInvalidArgument)
      << "one more than promised";
  EXPECT_TRUE(writer->finish().ok());
  EXPECT_TRUE(RawFrameReader::open(path).ok());
}

TEST_F(RawFramesTest, AFullDiskIsSaid) {
  if (!std::ofstream("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  Result<RawFrameWriter> writer = RawFrameWriter::create("/dev/full", kCamera, 1);
  Status status = Done{};
  if (writer.ok()) status = writer->append(frame_number(0));
  if (writer.ok() && status.ok()) status = writer->finish();
  const Error error = writer.ok() ? status.error() : writer.error();
  EXPECT_EQ(error.code, ErrorCode::kIo);
  EXPECT_THAT(error.message, HasSubstr("No space left"));
}

}  // namespace
}  // namespace hermite
