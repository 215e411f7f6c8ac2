// What goes wrong while somebody scans: a hand before the lens, frames that never arrive. For tests of lost tracking and relocalisation.
//
// Written behind any source, as often as wanted and applied from left to right; frames are counted from 0 in what stands left of it:
//   +covered=FROM:COUNT   a hand before the lens: no depth, a dark picture
//   +missing=FROM:COUNT   these frames are not there: fewer frames, a gap in the time stamps
// The ground truth stays whole.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite {

// Frames from, ..., from + count - 1.
struct FrameSpan {
  std::int64_t from = 0, count = 0;
  bool operator==(const FrameSpan&) const = default;
};

// "FROM:COUNT", whole numbers, a count of at least 1. kInvalidArgument with the text and what is allowed.
Result<FrameSpan> parse_frame_span(const std::string& text);

// The same sequence with those frames covered. kInvalidArgument, naming the frame count: the span leaves the sequence.
Result<std::unique_ptr<Sequence>> with_covered(std::unique_ptr<Sequence> sequence, const FrameSpan& span);

// The same sequence without those frames. kInvalidArgument: the span leaves the sequence, or no frame would be left.
Result<std::unique_ptr<Sequence>> with_missing(std::unique_ptr<Sequence> sequence, const FrameSpan& span);

}  // namespace hermite
