#include "core/disturb/redrawn_sequence.h"

#include "core/image/image_codec.h"

namespace hermite::disturb {

Result<dataset::RecordedFrame> RedrawnSequence::read(std::int64_t index) const {
  Result<dataset::RecordedFrame> frame = original_->read(index);
  if (!frame.ok()) return frame;
  auto color = image::decode_color(frame->color_bytes, {frame->depth.width, frame->depth.height});
  if (!color.ok()) return in_context("colour image", color.error());
  const ColorImage as_it_was = *color;
  if (const Status status = redraw(frame->depth, *color, index); !status.ok())
    return status.error();
  if (*color == as_it_was) return frame;
  auto encoded = image::encode_jpeg(*color, kDisturbedJpegQuality);
  if (!encoded.ok()) return encoded.error();
  frame->color_bytes = std::move(*encoded);
  return frame;
}

}  // namespace hermite::disturb
