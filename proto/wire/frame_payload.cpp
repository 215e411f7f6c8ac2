#include "proto/wire/frame_payload.h"

#include <cstdint>
#include <span>
#include <utility>

#include "core/image/depth_codec.h"
#include "core/image/depth_ranks.h"
#include "core/image/image_codec.h"

namespace hermite::wire {

namespace {

std::span<const std::uint8_t> bytes_of(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

std::string text_of(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

}  // namespace

Result<DepthImage> decode_depth_payload(const std::string& payload, DepthCodec depth_codec,
                                        const Camera& camera) {
  const image::ImageSize expected{camera.width, camera.height};
  switch (depth_codec) {
    case DepthCodec::kRvlZstd: return image::decode_depth_rvl_zstd(bytes_of(payload), expected);
    case DepthCodec::kRanks: return image::decode_depth_ranks(bytes_of(payload), expected);
    case DepthCodec::kPng16: break;
  }
  return image::decode_depth_png(bytes_of(payload), expected);
}

std::size_t max_frame_message_bytes(const Camera& camera) {
  return kMaxBytesBeforeWelcome +
         8 * static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height);
}

Result<frame::RgbdFrame> decode_frame_payload(const Frame& frame, DepthCodec depth_codec,
                                              const Camera& camera) {
  Result<DepthImage> depth = decode_depth_payload(frame.depth, depth_codec, camera);
  if (!depth.ok()) return in_context("frame.depth", depth.error());
  Result<ColorImage> color =
      image::decode_color(bytes_of(frame.color), {camera.width, camera.height});
  if (!color.ok()) return in_context("frame.color", color.error());
  return frame::RgbdFrame{frame.timestamp_s, *std::move(depth), *std::move(color),
                          frame.acceleration_m_s2};
}

Result<std::string> encode_depth_payload(const DepthImage& depth, DepthCodec depth_codec) {
  switch (depth_codec) {
    case DepthCodec::kRvlZstd: return text_of(image::encode_depth_rvl_zstd(depth));
    case DepthCodec::kRanks: return text_of(image::encode_depth_ranks(depth));
    case DepthCodec::kPng16: break;
  }
  const Result<std::vector<std::uint8_t>> bytes = image::encode_depth_png(depth);
  if (!bytes.ok()) return bytes.error();
  return text_of(*bytes);
}

frame::RgbdFrame empty_frame(double timestamp_s, const Camera& camera) {
  return {timestamp_s, DepthImage(camera.width, camera.height),
          ColorImage(camera.width, camera.height)};
}

}  // namespace hermite::wire
