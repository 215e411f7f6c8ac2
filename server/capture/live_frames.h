// The newest frame of a camera as a source to stream from: who is too slow gets fewer, never older ones.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <optional>
#include <vector>

#include "core/frame/rgbd_frame.h"
#include "server/client/frame_source.h"

namespace hermite {

// The captured images as they go on the wire, all but the number. Of a valid camera's size (CHECK).
wire::Frame encode_captured(const RgbdFrame& frame, wire::DepthCodec depth_codec, int jpeg_quality);

class LiveFrames final : public FrameSource {
 public:
  LiveFrames(const Camera& camera, std::vector<wire::DepthCodec> depth_codecs);

  // From any thread; never waits. One that was not taken before the next comes is dropped. False: nobody has asked for the first one yet,
  // it is thrown away.
  bool offer(RgbdFrame frame);
  void close();  // there will be no more

  std::uint64_t dropped_count() const;

  const Camera& camera() const override { return camera_; }
  std::uint64_t expected_frames() const override { return 0; }
  std::vector<wire::DepthCodec> depth_codecs() const override { return depth_codecs_; }
  Supply next(const WireEncoding& encoding, EncodedFrame& frame) override;

 private:
  const Camera camera_;
  const std::vector<wire::DepthCodec> depth_codecs_;
  std::int64_t taken_count_ = 0;  // the taker's thread only

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::optional<RgbdFrame> newest_;  // guarded by mutex_, as all below
  std::uint64_t dropped_count_ = 0;
  bool asked_ = false;
  bool closed_ = false;
};

}  // namespace hermite
