#include "server/capture/live_frames.h"

#include <gtest/gtest.h>

#include <thread>

#include "core/image/image_codec.h"
#include "proto/wire/frame_payload.h"

namespace hermite::client::live_frames_test {
namespace {

const Camera kCamera{64, 64, 60, 60, 31.5, 31.5, 1000};

frame::RgbdFrame frame_at(double time_s) {
  frame::RgbdFrame frame = wire::empty_frame(time_s, kCamera);
  for (std::size_t k = 0; k < frame.depth.pixels.size(); ++k)
    frame.depth.pixels[k] = static_cast<std::uint16_t>(1000 + k);
  return frame;
}

LiveFrames live() { return {kCamera, {wire::DepthCodec::kRanks, wire::DepthCodec::kRvlZstd}}; }

TEST(EncodeCaptured, DepthIsLosslessAndColourAJpegOfTheQuality) {
  frame::RgbdFrame frame = frame_at(3.5);
  for (std::size_t k = 0; k < frame.color.pixels.size(); ++k)
    frame.color.pixels[k] = {static_cast<std::uint8_t>(k * 37), 90, 20};
  for (const wire::DepthCodec codec : wire::kDepthCodecs) {
    const wire::Frame encoded = encode_captured(frame, codec, 90);
    const auto decoded = wire::decode_frame_payload(encoded, codec, kCamera);
    ASSERT_TRUE(decoded.ok()) << decoded.error().message;
    EXPECT_EQ(decoded->timestamp_s, 3.5);
    EXPECT_EQ(decoded->depth, frame.depth);
  }
  EXPECT_LT(encode_captured(frame, wire::DepthCodec::kRanks, 50).color.size(),
            encode_captured(frame, wire::DepthCodec::kRanks, 95).color.size());
}

TEST(LiveFrames, FramesBeforeTheFirstQuestionAreThrownAway) {
  LiveFrames frames = live();
  EXPECT_FALSE(frames.offer(frame_at(1)));
  EncodedFrame frame;
  EXPECT_EQ(frames.next({}, frame), Supply::kNotYet);
  EXPECT_TRUE(frames.offer(frame_at(2)));
  ASSERT_EQ(frames.next({}, frame), Supply::kFrame);
  EXPECT_EQ(frame.frame.timestamp_s, 2);
  EXPECT_EQ(frame.index, 0);
  EXPECT_EQ(frames.dropped_count(), 0u);
}

TEST(LiveFrames, OnlyTheNewestIsGivenTheOthersAreCounted) {
  LiveFrames frames = live();
  EncodedFrame frame;
  EXPECT_EQ(frames.next({}, frame), Supply::kNotYet);
  for (int k = 0; k < 4; ++k) EXPECT_TRUE(frames.offer(frame_at(k)));
  ASSERT_EQ(frames.next({}, frame), Supply::kFrame);
  EXPECT_EQ(frame.frame.timestamp_s, 3);
  EXPECT_EQ(frames.dropped_count(), 3u);
}

TEST(LiveFrames, TheEncodingIsTheTakers) {
  LiveFrames frames = live();
  EncodedFrame frame;
  EXPECT_EQ(frames.next({}, frame), Supply::kNotYet);
  frames.offer(frame_at(1));
  ASSERT_EQ(frames.next({.depth = wire::DepthCodec::kPng16}, frame), Supply::kFrame);
  const std::vector<std::uint8_t> bytes(frame.frame.depth.begin(), frame.frame.depth.end());
  EXPECT_EQ(*image::detect_image_format(bytes), image::ImageFormat::kPng);
}

TEST(LiveFrames, TheLastFrameComesBeforeTheEnd) {
  LiveFrames frames = live();
  EncodedFrame frame;
  EXPECT_EQ(frames.next({}, frame), Supply::kNotYet);
  frames.offer(frame_at(1));
  frames.close();
  EXPECT_FALSE(frames.offer(frame_at(2)));
  EXPECT_EQ(frames.next({}, frame), Supply::kFrame);
  EXPECT_EQ(frames.next({}, frame), Supply::kEnd);
}

TEST(LiveFrames, AFrameEndsTheWait) {
  LiveFrames frames = live();
  EncodedFrame frame;
  Supply supply = Supply::kNotYet;
  std::thread taker([&] {
    for (int i = 0; i < 600 && supply == Supply::kNotYet; ++i) supply = frames.next({}, frame);
  });
  while (!frames.offer(frame_at(1))) std::this_thread::yield();
  taker.join();
  EXPECT_EQ(supply, Supply::kFrame);
}

}  // namespace
}  // namespace hermite::client::live_frames_test
