// A source of a few small frames, which a server would not understand, for tests of how frames are
// sent.
#pragma once

#include <string>
#include <vector>

#include "server/client/frame_source.h"

namespace hermite::test {

class FewFrames final : public client::FrameSource {
 public:
  explicit FewFrames(int count, std::size_t bytes = 10) : count_(count), bytes_(bytes) {}
  const Camera& camera() const override { return camera_; }
  std::uint64_t expected_frames() const override { return static_cast<std::uint64_t>(count_); }
  std::vector<wire::DepthCodec> depth_codecs() const override {
    return {wire::DepthCodec::kRvlZstd};
  }
  client::Supply next(const client::WireEncoding&, client::EncodedFrame& frame) override {
    if (next_ == count_) return client::Supply::kEnd;
    frame.index = next_;
    frame.frame.timestamp_s = next_++;
    frame.frame.depth = std::string(bytes_, 'd');
    frame.problem = "frame " + std::to_string(frame.index) + " is no image";
    return client::Supply::kFrame;
  }

 private:
  const Camera camera_;
  const int count_;
  const std::size_t bytes_;
  int next_ = 0;
};

}  // namespace hermite::test
