// .klg and .sens, which share core/dataset/frame_file.h.
#include "core/dataset/frame_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/source/open_sequence.h"
#include "tests/core/dataset/recording_bytes.h"
#include "tests/core/dataset/rendered_once.h"
#include "tests/core/dataset/temp_folder.h"
#include "tests/support/joined.h"

namespace hermite::dataset {
namespace {

using test::FileOptions;
using testing::HasSubstr;

// The size of klg files is the one that ElasticFusion assumes: smaller ones need a camera.
const char* const kKlgSource = "synthetic:frames=3,width=640,height=480";
const char* const kFourFrames = "synthetic:frames=4,width=96,height=72";

void expect_same_depth(const Sequence& found, const Sequence& source) {
  ASSERT_EQ(found.frame_count(), source.frame_count());
  for (std::int64_t i = 0; i < source.frame_count(); ++i) {
    const auto frame = found.read(i);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    EXPECT_EQ(frame->depth, source.read(i)->depth);
  }
}

TEST(Klg, EveryMixOfCodingsReadsBack) {
  const test::RenderedOnce source(kKlgSource);
  const TempFolder folder;
  for (const FileOptions options : {FileOptions{}, FileOptions{true, true},
                                    FileOptions{true, false}, FileOptions{false, true}}) {
    folder.write("a.bin", test::klg_bytes(source, options));
    const auto recording = open_recording(folder.path("a.bin"));
    ASSERT_TRUE(recording.ok()) << recording.error().message;
    const Sequence& found = *recording->sequence;
    EXPECT_EQ(found.format(), "klg");
    EXPECT_EQ(found.camera().fx, 528);
    EXPECT_THAT(test::joined(recording->doubts), HasSubstr("ElasticFusion's default"));
    expect_same_depth(found, source);
    EXPECT_NEAR(found.timestamp_s(2), 1000 + source.timestamp_s(2), 1e-6);
    const auto color = decode_frame(*found.read(1))->color;
    if (options.raw_color) {
      EXPECT_EQ(color, test::frame_of(source, 1).color);
    }
  }
}

// Its first frame has a small time stamp, which could be the length of a name, and nothing in view.
TEST(Klg, FourBlackFramesAreNoSens) {
  const TempFolder folder;
  test::Bytes bytes{4, 0, 0, 0};
  for (std::uint8_t frame = 0; frame < 4; ++frame) {
    constexpr std::uint32_t kDepthBytes = 640 * 480 * 2;
    bytes.insert(bytes.end(), {frame, 0, 0, 0, 0, 0, 0, 0});
    for (int shift = 0; shift < 32; shift += 8)
      bytes.push_back(static_cast<std::uint8_t>(kDepthBytes >> shift));
    bytes.insert(bytes.end(), 4 + kDepthBytes, 0);
  }
  folder.write("a.klg", bytes);
  EXPECT_FALSE(probe_sens(folder.path("a.klg")));
  const auto recording = open_recording(folder.path("a.klg"));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ(recording->sequence->format(), "klg");
}

TEST(Klg, MissingColourIsBlackAndSaid) {
  const test::RenderedOnce source(kKlgSource);
  const TempFolder folder;
  folder.write("a.klg", test::klg_bytes(source, {true, false, true}));
  const auto recording = open_recording(folder.path("a.klg"));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_THAT(test::joined(recording->doubts), HasSubstr("3 frames have no colour"));
  EXPECT_EQ(decode_frame(*recording->sequence->read(0))->color, ColorImage(640, 480));
}

TEST(Klg, TheCameraBesideTheFileDecidesTheSize) {
  const auto source = *source::open_sequence(kFourFrames);
  const TempFolder folder;
  folder.write("a.klg", test::klg_bytes(*source));
  EXPECT_THAT(open_recording(folder.path("a.klg")).error().message, HasSubstr("give a camera"));
  folder.write("camera.json",
               R"({"width": 96, "height": 72, "fx": 80, "fy": 80, "cx": 48, "cy": 36, )"
               R"("depth_units_per_metre": 1000})");
  auto recording = open_recording(folder.path("a.klg"));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ(recording->camera_source, "camera.json");
  expect_same_depth(*recording->sequence, *source);
  EXPECT_EQ(recording->sequence->camera().fx, 80);
  // The folder holds the file: giving the folder is enough.
  EXPECT_THAT(open_recording(folder.path())->format_reason, HasSubstr("in a.klg"));
  const Camera wrong{80, 64, 70, 70, 40, 32, 1000};
  EXPECT_THAT(open_recording(folder.path("a.klg"), wrong).error().message, HasSubstr("96x72"));
}

TEST(Klg, LengthsAreJudgedBeforeAnythingIsAllocated) {
  const test::RenderedOnce source(kKlgSource);
  const TempFolder folder;
  const auto error_with = [&](std::size_t offset, std::int32_t value) {
    test::Bytes bytes = test::klg_bytes(source);
    std::memcpy(bytes.data() + offset, &value, sizeof value);
    folder.write("a.klg", bytes);
    const auto recording = open_klg(folder.path("a.klg"), std::nullopt);
    return recording.ok() ? "opened" : recording.error().message;
  };
  EXPECT_THAT(error_with(0, 0), HasSubstr("offset 0: num_frames is 0"));
  EXPECT_THAT(error_with(0, -1), HasSubstr("num_frames is -1"));
  EXPECT_THAT(error_with(0, 2'000'000'000), HasSubstr("num_frames is 2000000000"));
  EXPECT_THAT(error_with(0, 4), HasSubstr("frame 3 of 4: offset"));
  EXPECT_THAT(error_with(12, 0), HasSubstr("offset 12: depth_size"));
  EXPECT_THAT(error_with(12, -5), HasSubstr("depth_size is -5"));
  EXPECT_THAT(error_with(12, 0x7fffffff), HasSubstr("depth_size is 2147483647, allowed is 1 to"));
  EXPECT_THAT(error_with(16, 40'000'000), HasSubstr("color_size is 40000000, but only"));
  // Fewer than there are is a doubt, not an error.
  EXPECT_THAT(error_with(0, 2), HasSubstr("opened"));
}

TEST(FrameFile, StampsGetTheUnitThatMakesSense) {
  std::vector<std::string> doubts;
  EXPECT_NEAR(seconds_of_stamps({5'000'000, 5'033'333, 5'066'666}, 30, doubts)[1], 5.033333, 1e-9);
  EXPECT_TRUE(doubts.empty());
  EXPECT_NEAR(seconds_of_stamps({0, 33'333'333, 66'666'666}, 30, doubts)[2], 0.066666666, 1e-9);
  EXPECT_THAT(test::joined(doubts), HasSubstr("nanoseconds"));
  EXPECT_NEAR(seconds_of_stamps({100, 133, 166}, 30, doubts)[2], 0.166, 1e-9);
  EXPECT_THAT(test::joined(doubts), HasSubstr("milliseconds"));
  doubts.clear();
  EXPECT_NEAR(seconds_of_stamps({7, 7, 7}, 10, doubts)[2], 0.2, 1e-9);
  EXPECT_THAT(test::joined(doubts), HasSubstr("do not ascend"));
  // So large that neighbours are one double.
  const auto far = seconds_of_stamps({INT64_MAX - 1, INT64_MAX}, 30, doubts);
  EXPECT_LT(far[0], far[1]);
  EXPECT_EQ(seconds_of_stamps({42}, 30, doubts).size(), 1u);
}

TEST(Sens, EveryMixOfCodingsReadsBackWithPosesAndCamera) {
  const auto source = *source::open_sequence(kFourFrames);
  const TempFolder folder;
  for (const FileOptions options :
       {FileOptions{}, FileOptions{true, true}, FileOptions{true, false}}) {
    folder.write("a.sens", test::sens_bytes(*source, options));
    const auto recording = open_recording(folder.path("a.sens"));
    ASSERT_TRUE(recording.ok()) << recording.error().message;
    const Sequence& found = *recording->sequence;
    EXPECT_EQ(found.format(), "sens");
    EXPECT_NEAR(found.camera().fx, source->camera().fx, 1e-4);
    EXPECT_EQ(found.camera().depth_units_per_metre, 5000);
    EXPECT_FALSE(found.camera().color.has_value());
    expect_same_depth(found, *source);
    ASSERT_EQ(found.groundtruth().size(), 4u);
    const Rigid3 difference = inverse(found.groundtruth()[3].world_from_camera) *
                              source->groundtruth()[3].world_from_camera;
    EXPECT_LT(difference.translation.norm(), 1e-5);
    EXPECT_LT(angle_rad(difference.rotation), 1e-5);
    if (options.raw_color) {
      EXPECT_EQ(decode_frame(*found.read(1))->color, test::frame_of(*source, 1).color);
    }
  }
}

TEST(Sens, LargerColourIsBroughtToTheDepthsSize) {
  const auto source = *source::open_sequence(kFourFrames);
  const TempFolder folder;
  folder.write("a.sens", test::sens_bytes(*source, {.raw_color = true, .color_factor = 3}));
  auto recording = open_recording(folder.path("a.sens"));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_FALSE(recording->sequence->camera().color.has_value()) << "the same camera";
  EXPECT_EQ(decode_frame(*recording->sequence->read(2))->color, test::frame_of(*source, 2).color);

  Eigen::Matrix4d beside = Eigen::Matrix4d::Identity();
  beside(0, 3) = -0.025;
  folder.write("a.sens", test::sens_bytes(*source, {}, beside));
  recording = open_recording(folder.path("a.sens"));
  ASSERT_TRUE(recording->sequence->camera().color.has_value());
  EXPECT_NEAR(recording->sequence->camera().color->color_from_depth.translation.x(), -0.025, 1e-6);
}

TEST(Sens, LostPosesAreLeftOut) {
  const auto source = *source::open_sequence(kFourFrames);
  const TempFolder folder;
  test::Bytes bytes = test::sens_bytes(*source);
  const std::size_t first_pose = 4 + 8 + 15 + 4 * 64 + 8 + 16 + 4 + 8;
  const float lost = -std::numeric_limits<float>::infinity();
  for (std::size_t i = 0; i < 16; ++i) std::memcpy(bytes.data() + first_pose + 4 * i, &lost, 4);
  folder.write("a.sens", bytes);
  const auto recording = open_recording(folder.path("a.sens"));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ(recording->sequence->groundtruth().size(), 3u);
  EXPECT_THAT(test::joined(recording->doubts), HasSubstr("1 of 4 frames have no valid pose"));
}

TEST(Sens, FieldsAreJudgedWithTheirPlace) {
  const auto source = *source::open_sequence(kFourFrames);
  const TempFolder folder;
  const auto error_with = [&](std::size_t offset, std::uint32_t value) {
    test::Bytes bytes = test::sens_bytes(*source);
    std::memcpy(bytes.data() + offset, &value, sizeof value);
    folder.write("a.sens", bytes);
    const auto recording = open_sens(folder.path("a.sens"), std::nullopt);
    return recording.ok() ? "opened" : recording.error().message;
  };
  constexpr std::size_t kCodings = 4 + 8 + 15 + 4 * 64;
  EXPECT_THAT(error_with(0, 3), HasSubstr("offset 0: version is 3, only 4 is read"));
  EXPECT_THAT(error_with(4, 0xffffffff), HasSubstr("offset 4: sensor name length"));
  EXPECT_THAT(error_with(kCodings, 7), HasSubstr("colour coding is 7"));
  EXPECT_THAT(error_with(kCodings + 4, 2), HasSubstr("depth coding is 2"));
  EXPECT_THAT(error_with(kCodings + 8, 100'000), HasSubstr("colour size is 100000x"));
  EXPECT_THAT(error_with(kCodings + 16, 4096), HasSubstr("depth size is 4096x"));
  EXPECT_THAT(error_with(kCodings + 24, 0x7fc00000), HasSubstr("calibration"));  // not a number
  EXPECT_THAT(error_with(kCodings + 28, 0x7fffffff), HasSubstr("num_frames is 2147483647"));
  EXPECT_THAT(error_with(kCodings + 36 + 64 + 16, 60'000'000), HasSubstr("frame 0 of 4: offset"));
  EXPECT_THAT(error_with(kCodings + 36 + 64 + 20, 0xffffffff),
              HasSubstr("colour size is 9223372036854775807, allowed is 0 to"));
}

}  // namespace
}  // namespace hermite::dataset
