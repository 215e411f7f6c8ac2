#include "core/dataset/frame_range.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

namespace hermite::dataset {
namespace {

// Returns the number that is the whole of `text`, or `missing` if the text is empty.
std::optional<std::int64_t> parse_bound(std::string_view text, std::int64_t missing) {
  if (text.empty()) return missing;
  if (text.front() == '-') return std::nullopt;
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

Error range_error(const std::string& text, std::int64_t frame_count, const std::string& message) {
  return {ErrorCode::kInvalidArgument,
          fmt::format("frames \"{}\": {} (the sequence has {} frames, 0 is the first)", text,
                      message, frame_count)};
}

}  // namespace

Result<FrameRange> parse_frame_range(const std::string& text, std::int64_t frame_count) {
  if (text.empty()) {
    if (frame_count < 1) return range_error(text, frame_count, "there is no frame");
    return FrameRange{0, frame_count};
  }
  const std::size_t colon = text.find(':');
  if (colon == std::string::npos) return range_error(text, frame_count, "expected A:B");
  const auto begin = parse_bound(std::string_view(text).substr(0, colon), 0);
  const auto end = parse_bound(std::string_view(text).substr(colon + 1), frame_count);
  if (!begin || !end)
    return range_error(text, frame_count, "expected A:B with whole numbers from 0");
  const FrameRange range{*begin, std::min(*end, frame_count)};
  if (range.count() < 1) return range_error(text, frame_count, "there is no frame in this range");
  return range;
}

}  // namespace hermite::dataset
