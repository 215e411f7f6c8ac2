// A source of frames to stream that holds only the newest frame of a camera: a slow consumer gets
// fewer frames, never outdated ones.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "core/frame/rgbd_frame.h"
#include "server/client/frame_source.h"

namespace hermite::client {

// Encodes captured images for the wire, without a sequence number. The size must be that of a valid
// camera (CHECK).
wire::Frame encode_captured(const frame::RgbdFrame& frame, wire::DepthCodec depth_codec,
                            int jpeg_quality);

class LiveFrames final : public FrameSource {
 public:
  LiveFrames(const Camera& camera, std::vector<wire::DepthCodec> depth_codecs);

  // May be called from any thread; never waits. A frame that was not taken before the next one
  // arrives is dropped. Returns false if the consumer has not asked for the first frame yet; the
  // frame is then discarded.
  bool offer(frame::RgbdFrame frame);
  void close();  // there will be no more frames

  std::uint64_t dropped_count() const;

  const Camera& camera() const override { return camera_; }
  std::uint64_t expected_frames() const override { return 0; }
  std::vector<wire::DepthCodec> depth_codecs() const override { return depth_codecs_; }
  Supply next(const WireEncoding& encoding, EncodedFrame& frame) override;

 private:
  const Camera camera_;
  const std::vector<wire::DepthCodec> depth_codecs_;
  std::int64_t taken_count_ = 0;  // only used on the consumer's thread

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<frame::RgbdFrame> newest_;  // guarded by mutex_, as all below
  std::uint64_t dropped_count_ = 0;
  bool asked_ = false;
  bool closed_ = false;
};

}  // namespace hermite::client
