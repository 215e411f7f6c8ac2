// The source of the frames of a stream: a recording, a camera, or a local log of a camera.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/math/camera.h"
#include "proto/wire/messages.h"

namespace hermite::client {

struct WireEncoding {
  wire::DepthCodec depth = wire::DepthCodec::kRvlZstd;
  bool png_color = true;  // false: PNG colour of a recording is sent as JPEG, which changes pixels
  // 1 to 100: colour is sent as a JPEG of that quality if that is smaller. std::nullopt: as
  // recorded.
  std::optional<int> jpeg_quality = std::nullopt;
};

struct EncodedFrame {
  std::int64_t index = 0;  // in the recording
  wire::Frame frame;       // complete except for its sequence number, which is set when it is sent
  // Why the images are black, as text; empty if they are those of the recording.
  std::string problem;
};

enum class Supply { kFrame, kNotYet, kEnd };

// The other functions are called on the taker's thread before the first next(); next() is called on
// one other thread.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const Camera& camera() const = 0;
  virtual std::uint64_t expected_frames() const = 0;  // 0: unknown
  // All that the source can encode, best first.
  virtual std::vector<wire::DepthCodec> depth_codecs() const = 0;

  // Returns the next frame, in order. Waits at most kSupplyPatience for one that is not available
  // yet; after kEnd there are no more.
  virtual Supply next(const WireEncoding& encoding, EncodedFrame& frame) = 0;
};

inline constexpr std::chrono::milliseconds kSupplyPatience{100};

}  // namespace hermite::client
