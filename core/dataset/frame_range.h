// The frames of a sequence that a run uses: `--frames A:B` of both programs. Plain value, pure
// functions.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite::dataset {

// Half open: frames begin, begin + 1, ..., end - 1.
struct FrameRange {
  std::int64_t begin = 0;
  std::int64_t end = 0;
  std::int64_t count() const { return end - begin; }
  bool operator==(const FrameRange&) const = default;
};

// Parses "A:B", "A:", ":B" or ":" with non-negative decimal numbers. An end beyond the sequence
// means the end of the sequence; empty text means every frame. kInvalidArgument, naming the text
// and the frame count, for anything else and for an empty range.
Result<FrameRange> parse_frame_range(const std::string& text, std::int64_t frame_count);

}  // namespace hermite::dataset
