// Where the frames of a stream come from: a recording, a camera, or what of a camera is already in a local log.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/math/camera.h"
#include "proto/wire/messages.h"

namespace hermite {

struct WireEncoding {
  wire::DepthCodec depth = wire::DepthCodec::kRvlZstd;
  bool png_color = true;  // false: PNG colour of a recording is sent as JPEG, which changes pixels
  // 1 to 100: colour becomes a JPEG of that quality where this makes it smaller. None: as recorded.
  std::optional<int> jpeg_quality = std::nullopt;
};

struct EncodedFrame {
  std::int64_t index = 0;  // in the recording
  wire::Frame frame;       // all but its number on the wire, which is known when it leaves
  std::string problem;     // in words, why the images are black; empty when they are the recording's
};

enum class Supply { kFrame, kNotYet, kEnd };

// What is asked on the taker's thread before the first next() needs no thread but that; next() is called on one other thread.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual const Camera& camera() const = 0;
  virtual std::uint64_t expected_frames() const = 0;               // 0: nobody knows
  virtual std::vector<wire::DepthCodec> depth_codecs() const = 0;  // all that the source can encode, best first

  // The next frame, in order. Waits at most kSupplyPatience for one that is not there yet; after kEnd there is none.
  virtual Supply next(const WireEncoding& encoding, EncodedFrame& frame) = 0;
};

inline constexpr std::chrono::milliseconds kSupplyPatience{100};

}  // namespace hermite
