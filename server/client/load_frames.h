// The frames of a sequence, encoded once for all cameras of a load test: otherwise encoding them
// would be most of its work.
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "core/dataset/sequence.h"
#include "server/client/frame_source.h"

namespace hermite::client {

// Thread-safe. The sequence must outlive it.
class LoadFrames {
 public:
  // Keeps about `max_bytes` of encoded frames; those beyond are encoded every time. Measures the
  // depth codecs, which takes some frames' time.
  LoadFrames(const dataset::Sequence& sequence, std::size_t max_bytes);

  const dataset::Sequence& sequence() const { return sequence_; }
  const std::vector<wire::DepthCodec>& depth_codecs() const { return depth_codecs_; }
  EncodedFrame frame(std::int64_t index, const WireEncoding& encoding);  // as encode_frame()
  std::size_t kept_count() const;

  // Encodes the first `count` frames as the cameras will ask for them, on all processors, until the
  // memory is used up or `go_on` returns false. That is called after each with the count so far, by
  // one thread at a time.
  void prepare(std::int64_t count, const std::function<bool(std::int64_t done)>& go_on);

 private:
  struct Key {
    std::int64_t index = 0;
    wire::DepthCodec depth;
    bool png_color = false;
    std::optional<int> jpeg_quality;
    auto operator<=>(const Key&) const = default;
  };
  // Not ready while another camera encodes it.
  using Kept = std::shared_future<std::shared_ptr<const EncodedFrame>>;

  bool full() const;
  std::shared_ptr<const EncodedFrame> encode(
      const Key& key, std::promise<std::shared_ptr<const EncodedFrame>> promise);

  const dataset::Sequence& sequence_;
  const std::size_t max_bytes_;
  const std::vector<wire::DepthCodec> depth_codecs_;
  mutable std::mutex mutex_;
  std::map<Key, Kept> kept_;    // guarded by mutex_
  std::size_t kept_bytes_ = 0;  // guarded by mutex_
};

// The frames for one scan of one camera, from the first to the last. `frames` must outlive it.
class LoadCameraFrames final : public FrameSource {
 public:
  explicit LoadCameraFrames(LoadFrames& frames) : frames_(frames) {}
  const Camera& camera() const override { return frames_.sequence().camera(); }
  std::uint64_t expected_frames() const override {
    return static_cast<std::uint64_t>(frames_.sequence().frame_count());
  }
  std::vector<wire::DepthCodec> depth_codecs() const override { return frames_.depth_codecs(); }
  Supply next(const WireEncoding& encoding, EncodedFrame& frame) override;

 private:
  LoadFrames& frames_;
  std::int64_t next_ = 0;
};

}  // namespace hermite::client
