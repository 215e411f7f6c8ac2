// Encodes the frames of a source for the wire, on a separate thread, so that reading and encoding
// overlap with the network.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"
#include "server/client/frame_source.h"

namespace hermite::client {

inline constexpr int kJpegQuality = 90;

// Sends colour as recorded, unless `encoding` requires otherwise. A frame that cannot be read or
// encoded becomes one without a measurement (depth 0, black colour) with its `problem`, as in a run
// without a server: every frame of the sequence gets its line in the trajectory. Thread-safe.
EncodedFrame encode_frame(const dataset::Sequence& sequence, std::int64_t index,
                          const WireEncoding& encoding);

// A recording or a part of it. The sequence must outlive it.
class RecordedFrames final : public FrameSource {
 public:
  RecordedFrames(const dataset::Sequence& sequence, const dataset::FrameRange& range)
      : sequence_(sequence), range_(range), next_(range.begin) {}
  const Camera& camera() const override { return sequence_.camera(); }
  std::uint64_t expected_frames() const override {
    return static_cast<std::uint64_t>(range_.count());
  }
  std::vector<wire::DepthCodec> depth_codecs() const override;
  Supply next(const WireEncoding& encoding, EncodedFrame& frame) override;

 private:
  const dataset::Sequence& sequence_;
  const dataset::FrameRange range_;
  std::int64_t next_;
};

// Encodes the frames of a source, at most `read_ahead` before they are taken. The source must
// outlive it. Call take() and exhausted() on one thread.
class FrameEncoder {
 public:
  struct Settings {
    WireEncoding encoding;
    std::size_t read_ahead = 4;  // frames
  };
  // `on_ready` is called on the encoding thread after each frame and at the end; it must not block.
  FrameEncoder(FrameSource& source, const Settings& settings, std::function<void()> on_ready);
  ~FrameEncoder();  // stops after the current frame
  FrameEncoder(const FrameEncoder&) = delete;
  FrameEncoder& operator=(const FrameEncoder&) = delete;

  std::optional<EncodedFrame> take();  // std::nullopt: not ready yet, or exhausted
  bool exhausted() const;              // every frame of the source was taken

  // Applies to frames encoded from now on; those read ahead stay unchanged.
  void set_jpeg_quality(std::optional<int> quality);

 private:
  struct Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace hermite::client
