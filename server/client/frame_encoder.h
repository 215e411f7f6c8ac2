// Recorded frames as the bytes that go on the wire, prepared on a thread of their own so that reading and encoding overlap the network.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"
#include "proto/wire/messages.h"

namespace hermite {

struct WireEncoding {
  wire::DepthCodec depth = wire::DepthCodec::kRvlZstd;
  bool png_color = true;  // false: PNG colour of a recording is sent as JPEG, which changes pixels
  // 1 to 100: colour becomes a JPEG of that quality where this makes it smaller. None: as recorded.
  std::optional<int> jpeg_quality = std::nullopt;
};

inline constexpr int kJpegQuality = 90;

struct EncodedFrame {
  std::int64_t index = 0;  // in the sequence
  wire::Frame frame;       // all but its number on the wire, which is known when it leaves
  std::string problem;     // in words, why the images are black; empty when they are the recording's
};

// Colour bytes go out as they were recorded, but for `encoding`. A frame that cannot be read or encoded becomes one without a measurement
// (depth 0, black colour) with its `problem`, as in a run without a server: every frame of the sequence gets its line in the trajectory.
// Thread-safe.
EncodedFrame encode_frame(const Sequence& sequence, std::int64_t index, const WireEncoding& encoding);

// Encodes a range in order, at most `read_ahead` frames before the taker. The sequence must outlive it. take() and exhausted() from one
// thread.
class FrameEncoder {
 public:
  struct Settings {
    FrameRange range;
    WireEncoding encoding;
    std::size_t read_ahead = 4;  // frames
  };
  // `on_ready` is called on the encoding thread after each frame; it must not block.
  FrameEncoder(const Sequence& sequence, const Settings& settings, std::function<void()> on_ready);
  ~FrameEncoder();  // stops after the frame in work
  FrameEncoder(const FrameEncoder&) = delete;
  FrameEncoder& operator=(const FrameEncoder&) = delete;

  std::optional<EncodedFrame> take();  // none: not ready yet, or exhausted
  bool exhausted() const;              // every frame of the range was taken

  void set_jpeg_quality(std::optional<int> quality);  // of the frames encoded from now on; those read ahead stay as they are

 private:
  struct Worker;
  std::unique_ptr<Worker> worker_;
};

}  // namespace hermite
