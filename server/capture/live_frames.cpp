#include "server/capture/live_frames.h"

#include <utility>

#include "core/base/check.h"
#include "core/image/image_codec.h"
#include "proto/wire/frame_payload.h"
#include "server/client/frame_encoder.h"

namespace hermite::client {

wire::Frame encode_captured(const frame::RgbdFrame& frame, wire::DepthCodec depth_codec,
                            int jpeg_quality) {
  auto depth = wire::encode_depth_payload(frame.depth, depth_codec);
  const auto color = image::encode_jpeg(frame.color, jpeg_quality);
  CHECK(depth.ok() && color.ok(), "images of a valid camera's size can be encoded");
  return {.timestamp_s = frame.timestamp_s,
          .depth = *std::move(depth),
          .color = {color->begin(), color->end()},
          .acceleration_m_s2 = frame.acceleration_m_s2};
}

LiveFrames::LiveFrames(const Camera& camera, std::vector<wire::DepthCodec> depth_codecs)
    : camera_(camera), depth_codecs_(std::move(depth_codecs)) {}

bool LiveFrames::offer(frame::RgbdFrame frame) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_ || !asked_) return false;
    if (newest_) ++dropped_count_;
    newest_ = std::move(frame);
  }
  changed_.notify_one();
  return true;
}

void LiveFrames::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  changed_.notify_one();
}

std::uint64_t LiveFrames::dropped_count() const {
  const std::lock_guard lock(mutex_);
  return dropped_count_;
}

Supply LiveFrames::next(const WireEncoding& encoding, EncodedFrame& frame) {
  std::optional<frame::RgbdFrame> newest;
  {
    std::unique_lock lock(mutex_);
    asked_ = true;
    changed_.wait_for(lock, kSupplyPatience, [this] { return closed_ || newest_; });
    if (!newest_) return closed_ ? Supply::kEnd : Supply::kNotYet;
    newest = std::exchange(newest_, std::nullopt);
  }
  frame = {.index = taken_count_++,
           .frame = encode_captured(*newest, encoding.depth,
                                    encoding.jpeg_quality.value_or(kJpegQuality)),
           .problem = {}};
  return Supply::kFrame;
}

}  // namespace hermite::client
