// A few tiny frames of the synthetic room as a camera sends them. Rendered and encoded once. Header
// only.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/source/open_sequence.h"
#include "proto/wire/frame_payload.h"

namespace hermite::test {

inline constexpr int kFrameCount = 6;

inline const dataset::Sequence& room() {
  static const std::unique_ptr<dataset::Sequence> sequence = *source::open_sequence(
      "synthetic:frames=" + std::to_string(kFrameCount) + ",width=160,height=120");
  return *sequence;
}

inline const wire::Frame& room_frame(int index) {
  static const std::vector<wire::Frame> frames = [] {
    std::vector<wire::Frame> encoded;
    for (int i = 0; i < kFrameCount; ++i) {
      dataset::RecordedFrame frame = *room().read(i);
      encoded.push_back({static_cast<std::uint64_t>(i),
                         frame.timestamp_s,
                         *wire::encode_depth_payload(frame.depth, wire::DepthCodec::kRvlZstd),
                         {frame.color_bytes.begin(), frame.color_bytes.end()}});
    }
    return encoded;
  }();
  return frames[static_cast<std::size_t>(index)];
}

}  // namespace hermite::test
