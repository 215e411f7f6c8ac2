#include "server/client/frame_encoder.h"

#include <atomic>
#include <chrono>
#include <random>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/image/image_codec.h"
#include "proto/wire/frame_payload.h"

namespace hermite::client {
namespace {

using testing::HasSubstr;

std::vector<std::uint8_t> color_png(const Camera& camera, std::uint8_t shade) {
  ColorImage image(camera.width, camera.height);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      image.at(x, y) = {static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), shade};
  return *image::encode_png(image);
}

// A recording of 12 frames whose frame 3 cannot be read, as a folder with a missing file would
// give.
class ShortRecording : public dataset::Sequence {
 public:
  std::string format() const override { return "test"; }
  std::string name() const override { return "short"; }
  const Camera& camera() const override { return camera_; }
  double frame_rate_hz() const override { return 30; }
  std::int64_t frame_count() const override { return 12; }
  double timestamp_s(std::int64_t index) const override {
    return 100 + static_cast<double>(index) / 30;
  }
  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    ++read_count;
    if (index == 3) return Error{ErrorCode::kIo, "depth/3.png: no such file"};
    dataset::RecordedFrame frame{timestamp_s(index), DepthImage(camera_.width, camera_.height),
                                 color_png(camera_, static_cast<std::uint8_t>(index))};
    for (std::size_t k = 0; k < frame.depth.pixels.size(); ++k)
      frame.depth.pixels[k] = static_cast<std::uint16_t>(k * 7 + static_cast<std::size_t>(index));
    if (index == 5) frame.color_bytes = {'G', 'I', 'F'};
    return frame;
  }
  const dataset::Trajectory& groundtruth() const override { return groundtruth_; }

  mutable std::atomic<int> read_count{0};

 private:
  Camera camera_{96, 64, 90, 90, 47.5, 31.5, 1000};
  dataset::Trajectory groundtruth_;
};

// Of noise in JPEGs of high quality.
class JpegRecording final : public ShortRecording {
 public:
  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    dataset::RecordedFrame frame{
        timestamp_s(index), DepthImage(camera().width, camera().height), {}};
    ColorImage noise(camera().width, camera().height);
    std::mt19937 random(static_cast<unsigned>(index));
    for (Rgb8& pixel : noise.pixels) pixel = {static_cast<std::uint8_t>(random()), 100, 50};
    frame.color_bytes = *image::encode_jpeg(noise, 95);
    return frame;
  }
};

std::vector<EncodedFrame> take_all(FrameEncoder& encoder) {
  std::vector<EncodedFrame> frames;
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!encoder.exhausted() && std::chrono::steady_clock::now() < deadline) {
    if (auto frame = encoder.take()) frames.push_back(*std::move(frame));
    std::this_thread::yield();
  }
  return frames;
}

TEST(EncodeFrame, TheServerDecodesWhatALocalRunWouldSee) {
  const ShortRecording recording;
  for (const auto codec : wire::kDepthCodecs) {
    const EncodedFrame encoded = encode_frame(recording, 2, {codec, true});
    EXPECT_EQ(encoded.problem, "");
    const auto on_server = wire::decode_frame_payload(encoded.frame, codec, recording.camera());
    const auto local = dataset::decode_frame(*recording.read(2));
    ASSERT_TRUE(on_server.ok()) << on_server.error().message;
    EXPECT_EQ(on_server->timestamp_s, local->timestamp_s);
    EXPECT_EQ(on_server->depth, local->depth);
    EXPECT_EQ(on_server->color, local->color);
  }
}

TEST(EncodeFrame, ColourGoesOutAsItWasRecorded) {
  const ShortRecording recording;
  const auto recorded = recording.read(2);
  const EncodedFrame encoded = encode_frame(recording, 2, {});
  EXPECT_EQ(encoded.frame.color,
            std::string(recorded->color_bytes.begin(), recorded->color_bytes.end()));
}

TEST(EncodeFrame, WithoutPngOnTheServerColourBecomesJpeg) {
  const ShortRecording recording;
  const EncodedFrame encoded = encode_frame(recording, 2, {wire::DepthCodec::kRvlZstd, false});
  const std::vector<std::uint8_t> bytes(encoded.frame.color.begin(), encoded.frame.color.end());
  EXPECT_EQ(*image::detect_image_format(bytes), image::ImageFormat::kJpeg);
  EXPECT_TRUE(
      wire::decode_frame_payload(encoded.frame, wire::DepthCodec::kRvlZstd, recording.camera())
          .ok());
}

TEST(EncodeFrame, AJpegQualityMakesColourSmallerOrLeavesItAlone) {
  const ShortRecording recording;  // of PNGs, smooth enough to be smaller than any JPEG
  EXPECT_EQ(encode_frame(recording, 2, {.jpeg_quality = 70}).frame.color,
            encode_frame(recording, 2, {}).frame.color);

  const JpegRecording jpegs;
  const std::string recorded = encode_frame(jpegs, 0, {}).frame.color;
  const std::string smaller = encode_frame(jpegs, 0, {.jpeg_quality = 70}).frame.color;
  EXPECT_LT(smaller.size(), recorded.size());
  EXPECT_TRUE(image::decode_color(
                  {reinterpret_cast<const std::uint8_t*>(smaller.data()), smaller.size()}, {96, 64})
                  .ok());
  EXPECT_EQ(encode_frame(jpegs, 0, {.jpeg_quality = 100}).frame.color, recorded);
}

TEST(FrameEncoder, AJpegQualityHoldsForTheFramesFromThenOn) {
  const JpegRecording recording;
  RecordedFrames source(recording, {0, 6});
  FrameEncoder encoder(source, {.encoding = {}, .read_ahead = 1}, [] {});
  encoder.set_jpeg_quality(50);
  const auto frames = take_all(encoder);
  ASSERT_EQ(frames.size(), 6u);
  // The first may have been encoded before.
  EXPECT_EQ(frames.back().frame.color,
            encode_frame(recording, 5, {.jpeg_quality = 50}).frame.color);
  EXPECT_NE(frames.back().frame.color, encode_frame(recording, 5, {}).frame.color);
}

TEST(EncodeFrame, AnUnreadableFrameBecomesExactlyTheEmptyFrame) {
  const ShortRecording recording;
  for (const auto codec : wire::kDepthCodecs) {
    const EncodedFrame encoded = encode_frame(recording, 3, {codec, true});
    EXPECT_THAT(encoded.problem, HasSubstr("frame 3"));
    EXPECT_THAT(encoded.problem, HasSubstr("depth/3.png: no such file"));
    const auto on_server = wire::decode_frame_payload(encoded.frame, codec, recording.camera());
    const frame::RgbdFrame expected =
        wire::empty_frame(recording.timestamp_s(3), recording.camera());
    ASSERT_TRUE(on_server.ok()) << on_server.error().message;
    EXPECT_EQ(on_server->timestamp_s, expected.timestamp_s);
    EXPECT_EQ(on_server->depth, expected.depth);
    EXPECT_EQ(on_server->color, expected.color);
  }
}

TEST(EncodeFrame, ColourThatIsNoImageIsLeftToTheServerToJudge) {
  const ShortRecording recording;
  for (const bool png_color : {true, false}) {
    const EncodedFrame encoded =
        encode_frame(recording, 5, {wire::DepthCodec::kRvlZstd, png_color});
    EXPECT_EQ(encoded.frame.color, "GIF");
    EXPECT_EQ(encoded.problem, "");
  }
}

TEST(FrameEncoder, GivesTheRangeInOrderAndThenNothing) {
  const ShortRecording recording;
  RecordedFrames source(recording, {1, 9});
  FrameEncoder encoder(source, {.encoding = {}, .read_ahead = 2}, [] {});
  const auto frames = take_all(encoder);
  ASSERT_EQ(frames.size(), 8u);
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_EQ(frames[k].index, static_cast<std::int64_t>(k) + 1);
    EXPECT_EQ(frames[k].problem.empty(), frames[k].index != 3);
  }
  EXPECT_TRUE(encoder.exhausted());
  EXPECT_FALSE(encoder.take());
}

TEST(FrameEncoder, SaysWhenAFrameIsReadyAndNeverRunsFurtherAhead) {
  const ShortRecording recording;
  std::atomic<int> ready_count{0};
  RecordedFrames source(recording, {0, 12});
  FrameEncoder encoder(source, {.encoding = {}, .read_ahead = 3}, [&] { ++ready_count; });
  for (int taken = 0; taken < 12; ++taken) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (ready_count <= taken && std::chrono::steady_clock::now() < deadline)
      std::this_thread::yield();
    ASSERT_GT(ready_count, taken);
    EXPECT_LE(recording.read_count, taken + 3);
    ASSERT_TRUE(encoder.take());
  }
}

TEST(FrameEncoder, EndsInTheMiddleWhenItsOwnerGoes) {
  const ShortRecording recording;
  {
    RecordedFrames source(recording, {0, 12});
    FrameEncoder encoder(source, {.encoding = {}, .read_ahead = 2}, [] {});
  }
  EXPECT_LE(recording.read_count, 3);
}

}  // namespace
}  // namespace hermite::client
