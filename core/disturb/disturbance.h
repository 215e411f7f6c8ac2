// Interruptions of a scan: a hand in front of the lens, frames that never arrive. For tests of
// tracking failures and relocalisation.
//
// Appended to any source, any number of times, and applied from left to right; frames are counted
// from 0 in the sequence to the left:
//   +covered=FROM:COUNT   a hand in front of the lens: no depth, a dark image
//   +missing=FROM:COUNT   these frames are missing: fewer frames, a gap in the time stamps
// The ground truth stays complete.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

// Frames from, ..., from + count - 1.
struct FrameSpan {
  std::int64_t from = 0, count = 0;
  bool operator==(const FrameSpan&) const = default;
};

// Parses "FROM:COUNT", whole numbers, with a count of at least 1. kInvalidArgument with the text
// and what is allowed.
Result<FrameSpan> parse_frame_span(const std::string& text);

// Returns the same sequence with those frames covered. kInvalidArgument, naming the frame count,
// when the span exceeds the sequence.
Result<std::unique_ptr<dataset::Sequence>> with_covered(std::unique_ptr<dataset::Sequence> sequence,
                                                        const FrameSpan& span);

// Returns the same sequence without those frames. kInvalidArgument when the span exceeds the
// sequence, or no frame would be left.
Result<std::unique_ptr<dataset::Sequence>> with_missing(std::unique_ptr<dataset::Sequence> sequence,
                                                        const FrameSpan& span);

}  // namespace hermite::disturb
