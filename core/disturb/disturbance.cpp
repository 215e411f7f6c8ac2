#include "core/disturb/disturbance.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <string_view>

#include "core/dataset/changed_sequence.h"
#include "core/image/image_codec.h"

namespace hermite::disturb {
namespace {

constexpr int kJpegQuality = 90;
// A palm against the light: dark, reddish, slightly brighter towards one side, without an edge.
constexpr int kPalm_r = 26, kPalm_g = 14, kPalm_b = 10, kPalmGain = 14;

bool parse_whole(std::string_view text, std::int64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() && !text.empty() &&
         text.front() != '-';
}

ColorImage palm(int width, int height) {
  ColorImage color(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int gain = kPalmGain * (x + y) / (width + height);
      color.at(x, y) = {static_cast<std::uint8_t>(kPalm_r + gain),
                        static_cast<std::uint8_t>(kPalm_g + gain / 2),
                        static_cast<std::uint8_t>(kPalm_b + gain / 2)};
    }
  return color;
}

class Disturbed : public dataset::ChangedSequence {
 public:
  Disturbed(std::unique_ptr<dataset::Sequence> whole, const FrameSpan& span)
      : dataset::ChangedSequence(std::move(whole)), span_(span) {}

 protected:
  const FrameSpan span_;
};

class Covered : public Disturbed {
 public:
  using Disturbed::Disturbed;
  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    if (index < span_.from || index >= span_.from + span_.count) return original_->read(index);
    const int width = camera().width, height = camera().height;
    auto color = image::encode_jpeg(palm(width, height), kJpegQuality);
    if (!color.ok()) return color.error();
    return dataset::RecordedFrame{timestamp_s(index), DepthImage(width, height), std::move(*color)};
  }
};

class Missing : public Disturbed {
 public:
  using Disturbed::Disturbed;
  std::int64_t frame_count() const override { return original_->frame_count() - span_.count; }
  double timestamp_s(std::int64_t index) const override {
    return original_->timestamp_s(index_in_whole(index));
  }
  Result<dataset::RecordedFrame> read(std::int64_t index) const override {
    return original_->read(index_in_whole(index));
  }

 private:
  std::int64_t index_in_whole(std::int64_t index) const {
    return index < span_.from ? index : index + span_.count;
  }
};

Status check_inside(const FrameSpan& span, std::int64_t frame_count) {
  if (span.from >= 0 && span.count >= 1 && span.from < frame_count &&
      span.count <= frame_count - span.from)
    return Done{};
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("frames {}:{} (first and count) leave the sequence, which has {}",
                           span.from, span.count, frame_count)};
}

}  // namespace

Result<FrameSpan> parse_frame_span(const std::string& text) {
  const std::size_t colon = text.find(':');
  FrameSpan span;
  if (colon == std::string::npos ||
      !parse_whole(std::string_view(text).substr(0, colon), span.from) ||
      !parse_whole(std::string_view(text).substr(colon + 1), span.count) || span.count < 1)
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("\"{}\" is no FROM:COUNT: expected a frame from 0 and a count from 1", text)};
  return span;
}

Result<std::unique_ptr<dataset::Sequence>> with_covered(std::unique_ptr<dataset::Sequence> sequence,
                                                        const FrameSpan& span) {
  if (const Status status = check_inside(span, sequence->frame_count()); !status.ok())
    return in_context("covered", status.error());
  return std::unique_ptr<dataset::Sequence>(std::make_unique<Covered>(std::move(sequence), span));
}

Result<std::unique_ptr<dataset::Sequence>> with_missing(std::unique_ptr<dataset::Sequence> sequence,
                                                        const FrameSpan& span) {
  if (const Status status = check_inside(span, sequence->frame_count()); !status.ok())
    return in_context("missing", status.error());
  if (span.count == sequence->frame_count())
    return Error{ErrorCode::kInvalidArgument, "missing: no frame would be left"};
  return std::unique_ptr<dataset::Sequence>(std::make_unique<Missing>(std::move(sequence), span));
}

}  // namespace hermite::disturb
