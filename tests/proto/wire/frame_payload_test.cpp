#include "proto/wire/frame_payload.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/image/depth_codec.h"
#include "core/image/image_codec.h"
#include "tests/support/memory_peak.h"

namespace hermite::wire {
namespace {

using testing::HasSubstr;

Camera small() { return {80, 64, 70, 70, 39.5, 31.5, 1000}; }

DepthImage some_depth(int width, int height) {
  DepthImage depth(width, height);
  for (std::size_t i = 0; i < depth.pixels.size(); ++i)
    depth.pixels[i] = static_cast<std::uint16_t>(i % 7 == 0 ? 0 : 1000 + i);
  return depth;
}

ColorImage some_color(int width, int height) {
  ColorImage color(width, height);
  for (std::size_t i = 0; i < color.pixels.size(); ++i)
    color.pixels[i] = {static_cast<std::uint8_t>(i), 100, static_cast<std::uint8_t>(i / 80)};
  return color;
}

std::string text(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

Frame good_frame(DepthCodec codec) {
  return {4, 2.5, *encode_depth_payload(some_depth(80, 64), codec),
          text(*image::encode_png(some_color(80, 64)))};
}

TEST(FramePayload, EveryDepthCodecGivesTheSameFrame) {
  for (const DepthCodec codec : kDepthCodecs) {
    const Result<frame::RgbdFrame> frame = decode_frame_payload(good_frame(codec), codec, small());
    ASSERT_TRUE(frame.ok()) << frame.error().message;
    EXPECT_EQ(frame->timestamp_s, 2.5);
    EXPECT_EQ(frame->depth, some_depth(80, 64));
    EXPECT_EQ(frame->color, some_color(80, 64));
  }
}

TEST(FramePayload, AnotherCodecThanAgreedIsAnErrorOfTheDepth) {
  const auto frame =
      decode_frame_payload(good_frame(DepthCodec::kPng16), DepthCodec::kRvlZstd, small());
  ASSERT_FALSE(frame.ok());
  EXPECT_THAT(frame.error().message, HasSubstr("frame.depth"));
}

TEST(FramePayload, ImagesOfAnotherSizeAreNamed) {
  Frame frame = good_frame(DepthCodec::kRvlZstd);
  frame.color = text(*image::encode_png(some_color(64, 80)));
  EXPECT_THAT(decode_frame_payload(frame, DepthCodec::kRvlZstd, small()).error().message,
              HasSubstr("frame.color"));
  frame = good_frame(DepthCodec::kRvlZstd);
  frame.depth = text(image::encode_depth_rvl_zstd(some_depth(80, 65)));
  EXPECT_THAT(decode_frame_payload(frame, DepthCodec::kRvlZstd, small()).error().message,
              HasSubstr("frame.depth"));
}

TEST(FramePayload, EmptyCutAndGarbageImagesAreErrors) {
  for (const DepthCodec codec : kDepthCodecs) {
    const Frame good = good_frame(codec);
    for (const std::string& depth :
         {std::string(), good.depth.substr(0, good.depth.size() / 2), std::string(500, '\xff')}) {
      Frame frame = good;
      frame.depth = depth;
      EXPECT_FALSE(decode_frame_payload(frame, codec, small()).ok());
    }
    for (const std::string& color :
         {std::string(), good.color.substr(0, good.color.size() / 2), std::string(500, '\xff')}) {
      Frame frame = good;
      frame.color = color;
      EXPECT_FALSE(decode_frame_payload(frame, codec, small()).ok());
    }
  }
}

TEST(FramePayload, ABombTakesNoMoreMemoryThanTheExpectedImage) {
  // Black images of 16 million pixels shrink to a few kB; the camera's frame has 5120.
  Frame bomb = good_frame(DepthCodec::kRvlZstd);
  bomb.depth = text(image::encode_depth_rvl_zstd(DepthImage(4096, 4096)));
  bomb.color = text(*image::encode_png(ColorImage(4096, 4096)));
  ASSERT_LT(bomb.depth.size() + bomb.color.size(), 1u << 20);
  Frame color_bomb = good_frame(DepthCodec::kRvlZstd);
  color_bomb.color = bomb.color;
  const std::size_t growth_bytes = test::peak_growth_bytes([&] {
    EXPECT_FALSE(decode_frame_payload(bomb, DepthCodec::kRvlZstd, small()).ok());
    EXPECT_FALSE(decode_frame_payload(color_bomb, DepthCodec::kRvlZstd, small()).ok());
  });
  EXPECT_LT(growth_bytes, 8u << 20);  // decoded they would be 32 and 48 MiB
}

TEST(FramePayload, TheLimitLeavesRoomForTheWorstFrame) {
  const Camera camera = small();
  DepthImage noise(camera.width, camera.height);
  std::uint32_t state = 1;
  const auto next = [&state] { return state = state * 1664525u + 1013904223u; };
  for (std::uint16_t& pixel : noise.pixels) pixel = static_cast<std::uint16_t>(next() >> 16);
  ColorImage color(camera.width, camera.height);
  for (Rgb8& pixel : color.pixels)
    pixel = {static_cast<std::uint8_t>(next() >> 24), static_cast<std::uint8_t>(next() >> 24),
             static_cast<std::uint8_t>(next() >> 24)};
  for (const DepthCodec codec : kDepthCodecs) {
    const std::size_t size =
        encode_depth_payload(noise, codec)->size() + image::encode_png(color)->size();
    EXPECT_LT(size, max_frame_message_bytes(camera) - kMaxBytesBeforeWelcome);
  }
}

TEST(FramePayload, AnEmptyFrameHasTheCamerasSizeAndNothingOnIt) {
  const frame::RgbdFrame frame = empty_frame(1.5, small());
  EXPECT_EQ(frame.timestamp_s, 1.5);
  EXPECT_EQ(frame.depth, DepthImage(80, 64));
  EXPECT_EQ(frame.color, ColorImage(80, 64));
}

}  // namespace
}  // namespace hermite::wire
