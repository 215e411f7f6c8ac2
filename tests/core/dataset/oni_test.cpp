// .oni files: core/dataset/oni_file.h and what oni.cpp makes of it.
// tests/server/capture/openni_recorder_test.cpp has files that OpenNI2 wrote.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/dataset/oni_file.h"
#include "core/dataset/recording.h"
#include "core/source/open_sequence.h"
#include "tests/core/dataset/oni_bytes.h"
#include "tests/core/dataset/temp_folder.h"
#include "tests/support/archive_bytes.h"
#include "tests/support/joined.h"

namespace hermite::dataset {
namespace {

using test::OniOptions;
using testing::HasSubstr;
using testing::Not;

const Camera kOniCamera{96, 72, 80, 81, 47.5, 35.5, 1000};

std::unique_ptr<Sequence> source_of(std::int64_t frames = 4) {
  return *source::open_sequence(
      "synthetic:frames=" + std::to_string(frames) + ",width=96,height=72", kOniCamera);
}

Result<Recording> open_bytes(const TempFolder& folder, const test::Bytes& bytes) {
  folder.write("a.oni", bytes);
  return open_recording(folder.path("a.oni"));
}

std::string message_of(const Result<Recording>& recording) {
  return recording.ok() ? "opened" : recording.error().message;
}

// Depth to the bit; colour too unless it went through JPEG.
void expect_same_frames(const Sequence& found, const Sequence& source, bool exact_color,
                        std::int64_t first = 0) {
  ASSERT_EQ(found.frame_count(), source.frame_count() - first);
  for (std::int64_t i = 0; i < found.frame_count(); ++i) {
    const auto frame = found.read(i);
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    const frame::RgbdFrame expected = test::frame_of(source, i + first),
                           decoded = *decode_frame(*frame);
    EXPECT_EQ(decoded.depth, expected.depth);
    if (exact_color) {
      EXPECT_EQ(decoded.color, expected.color);
    }
    const auto jpeg = *image::decode_color(*image::encode_jpeg(expected.color, 95), {96, 72});
    if (!exact_color) {
      EXPECT_EQ(decoded.color, jpeg);
    }
    EXPECT_NEAR(found.timestamp_s(i) - found.timestamp_s(0),
                source.timestamp_s(i + first) - source.timestamp_s(first), 2e-6);
  }
}

TEST(Oni, EveryMixOfCodingsReadsBack) {
  const auto source = source_of();
  const TempFolder folder;
  for (const char* const depth_codec : {"NONE", "16zP", "16zT"})
    for (const char* const color_codec : {"NONE", "JPEG"})
      for (const bool old_positions : {false, true}) {
        const auto recording =
            open_bytes(folder, test::oni_bytes(*source, {.depth_codec = depth_codec,
                                                         .color_codec = color_codec,
                                                         .old_positions = old_positions}));
        ASSERT_TRUE(recording.ok()) << recording.error().message;
        EXPECT_EQ(recording->sequence->format(), "oni");
        EXPECT_THAT(recording->format_reason, HasSubstr("NI10"));
        EXPECT_THAT(recording->camera_source, HasSubstr("field of view (62 by 48 degrees)"));
        EXPECT_THAT(test::joined(recording->doubts), HasSubstr("registered to colour"));
        EXPECT_EQ(recording->doubts.size(), 1u) << test::joined(recording->doubts);
        const Camera& camera = recording->sequence->camera();
        EXPECT_NEAR(camera.fx, 80, 1e-9);
        EXPECT_NEAR(camera.fy, 81, 1e-9);
        EXPECT_EQ(camera.cx, 47.5);
        EXPECT_EQ(camera.depth_units_per_metre, 1000);
        EXPECT_NEAR(recording->sequence->timestamp_s(0), 1000, 1e-9);
        expect_same_frames(*recording->sequence, *source, std::string(color_codec) == "NONE");
      }
}

TEST(Oni, MirroredImagesAreTurnedBack) {
  const auto source = source_of();
  const TempFolder folder;
  const auto recording =
      open_bytes(folder, test::oni_bytes(*source, {.color_codec = "NONE", .mirrored = true}));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  expect_same_frames(*recording->sequence, *source, true);
  EXPECT_TRUE(
      open_bytes(folder, test::oni_bytes(*source, {.mirrored = true}))->sequence->read(3).ok())
      << "JPEG";
}

TEST(Oni, LargerColourIsBroughtToTheSizeOfDepth) {
  const auto source = source_of();
  const TempFolder folder;
  const auto recording =
      open_bytes(folder, test::oni_bytes(*source, {.color_codec = "NONE", .color_factor = 2}));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  expect_same_frames(*recording->sequence, *source, true);
}

TEST(Oni, ColourThatBeganLaterIsPairedByItsPlaceInTheFile) {
  const auto source = source_of(8);
  const TempFolder folder;
  const auto recording = open_bytes(folder, test::oni_bytes(*source, {.color_codec = "NONE",
                                                                      .color_frames_late = 3,
                                                                      .streams_from_zero = true}));
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_THAT(test::joined(recording->doubts), HasSubstr("by its place in the file"));
  EXPECT_THAT(test::joined(recording->doubts), HasSubstr("3 of 8 depth images have no colour"));
  expect_same_frames(*recording->sequence, *source, true, 3);
}

TEST(Oni, WhatTheFileDoesNotSayIsADoubtOrTakenFromBeside) {
  const auto source = source_of();
  const TempFolder folder;
  const auto without_view =
      open_bytes(folder, test::oni_bytes(*source, {.has_view = false, .has_color = false}));
  ASSERT_TRUE(without_view.ok()) << without_view.error().message;
  EXPECT_THAT(test::joined(without_view->doubts), HasSubstr("58 by 45 degrees is assumed"));
  EXPECT_THAT(test::joined(without_view->doubts), HasSubstr("all frames are black"));
  EXPECT_EQ(decode_frame(*without_view->sequence->read(0))->color, ColorImage(96, 72));

  EXPECT_EQ(open_bytes(folder, test::oni_bytes(*source, {.oni_pixel_format = 101}))
                ->sequence->camera()
                .depth_units_per_metre,
            10'000);

  folder.write("a.oni.camera.json",
               R"({"width": 96, "height": 72, "fx": 70, "fy": 70, "cx": 48, "cy": 36, )"
               R"("depth_units_per_metre": 1000})");
  const auto beside = open_recording(folder.path("a.oni"));
  ASSERT_TRUE(beside.ok()) << beside.error().message;
  EXPECT_EQ(beside->camera_source, "a.oni.camera.json");
  EXPECT_EQ(beside->sequence->camera().fx, 70);
  Camera wrong = kOniCamera;
  wrong.width = 100;
  EXPECT_THAT(message_of(open_recording(folder.path("a.oni"), wrong)),
              HasSubstr("96x72 pixels, the camera 100x72"));
}

TEST(Oni, ARecorderThatDiedLeavesWhatItHadWritten) {
  const auto source = source_of();
  const TempFolder folder;
  const auto unfinished = open_bytes(folder, test::oni_bytes(*source, {.has_end = false}));
  ASSERT_TRUE(unfinished.ok()) << unfinished.error().message;
  EXPECT_THAT(test::joined(unfinished->doubts), HasSubstr("is cut or damaged"));
  EXPECT_EQ(unfinished->sequence->frame_count(), 4);
  test::Bytes bytes = test::oni_bytes(*source);
  bytes.resize(bytes.size() * 6 / 10);
  const auto cut = open_bytes(folder, bytes);
  ASSERT_TRUE(cut.ok()) << cut.error().message;
  EXPECT_THAT(test::joined(cut->doubts), HasSubstr("offset"));
  EXPECT_LT(cut->sequence->frame_count(), 4);
  // Debian's OpenNI2 leaves zeros behind the end record.
  bytes = test::oni_bytes(*source);
  bytes.resize(2 * bytes.size());
  EXPECT_EQ(open_bytes(folder, bytes)->doubts.size(), 1u);
}

TEST(Oni, WhatIsNotReadIsRefusedWithAMessage) {
  const auto source = source_of();
  const TempFolder folder;
  EXPECT_THAT(message_of(open_bytes(folder, test::oni_bytes(*source, {.depth_codec = "LZMA"}))),
              HasSubstr("the codec is \"LZMA\""));
  EXPECT_THAT(message_of(open_bytes(folder, test::oni_bytes(*source, {.color_codec = "Im8z"}))),
              HasSubstr("codec \"Im8z\""));
  EXPECT_THAT(message_of(open_bytes(folder, test::oni_bytes(*source, {.cropped = true}))),
              HasSubstr("recorded cropped"));
  EXPECT_THAT(message_of(open_bytes(folder, test::oni_bytes(*source, {.oni_pixel_format = 102}))),
              HasSubstr("oniPixelFormat is 102"));
  const auto with_byte = [&](std::size_t at, std::uint8_t value) {
    test::Bytes bytes = test::oni_bytes(*source);
    bytes[at] = value;
    return message_of(open_bytes(folder, bytes));
  };
  EXPECT_THAT(with_byte(4, 2), HasSubstr("the file has version 2.0.1.0"));
  EXPECT_THAT(with_byte(24, 'X'), HasSubstr("offset 24: record header does not begin with NIR"));
  EXPECT_THAT(with_byte(24 + 12, 3), HasSubstr("bytes of fields are 3, allowed is 28 to 1048576"));
  EXPECT_THAT(with_byte(24 + 12, 40), HasSubstr("too few for what they hold"));
  EXPECT_THAT(with_byte(24 + 19, 0x70), HasSubstr("bytes of payload is 1879048192, but only"));
  EXPECT_THAT(with_byte(24 + 30, 1),
              HasSubstr("bytes of a node's name is 65543, allowed is 0 to 256"));
}

TEST(Oni, TimesThatDoNotAscendAreLeftOut) {
  const auto source = source_of();
  const TempFolder folder;
  test::OniWriter writer({});
  writer.node(1, "Depth", 2, "NONE");
  test::describe_stream(writer, 1, kOniCamera, 1, {});
  std::uint32_t number = 0;
  for (const std::uint64_t stamp_us : {100u, 40'000u, 40'000u, 90u, 80'000u})
    writer.image(1, stamp_us, ++number, test::raw_depth(source->read(0)->depth));
  writer.record(0x0b, 0);
  const auto recording = open_bytes(folder, writer.bytes);
  ASSERT_TRUE(recording.ok()) << recording.error().message;
  EXPECT_EQ(recording->sequence->frame_count(), 3);
  EXPECT_THAT(test::joined(recording->doubts),
              HasSubstr("2 images have no time after the one before"));
}

TEST(Oni, IsFoundInFoldersAndArchives) {
  const auto source = source_of();
  const TempFolder folder;
  const test::Bytes bytes = test::oni_bytes(*source);
  folder.write("x/scan.bin", bytes);
  EXPECT_EQ(open_recording(folder.path())->sequence->format(), "oni");
  folder.write("a.tar.zst", test::zstd_bytes(test::tar_bytes(
                                {{"kitchen/scan.oni", std::string(bytes.begin(), bytes.end())}})));
  const auto packed = open_recording(folder.path("a.tar.zst"));
  ASSERT_TRUE(packed.ok()) << packed.error().message;
  EXPECT_EQ(packed->sequence->frame_count(), 4);
}

TEST(OniFile, SaysWhatIsInIt) {
  const auto source = source_of();
  const TempFolder folder;
  folder.write("a.oni", test::oni_bytes(*source, {.mirrored = true}));
  const auto file = ByteFile::open(folder.path("a.oni"));
  ASSERT_TRUE(looks_like_oni(*file));
  const auto found = read_oni_file(*file);
  ASSERT_TRUE(found.ok()) << found.error().message;
  EXPECT_EQ(found->version, "1.0.1.0");
  EXPECT_EQ(found->depth->codec, "16zT");
  EXPECT_EQ(found->color->codec, "JPEG");
  EXPECT_EQ(found->depth->size, (image::ImageSize{96, 72}));
  EXPECT_EQ(found->color->frame_rate_hz, 30);
  EXPECT_TRUE(found->depth->is_mirrored);
  EXPECT_EQ(found->depth->images.size(), 4u);
  EXPECT_EQ(found->color->images[1].images_before, 2);
  EXPECT_THAT(found->cut, testing::IsEmpty());
}

}  // namespace
}  // namespace hermite::dataset
