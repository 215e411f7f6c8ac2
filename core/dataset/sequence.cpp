#include "core/dataset/sequence.h"

#include "core/image/image_codec.h"

namespace hermite::dataset {

Result<frame::RgbdFrame> decode_frame(RecordedFrame recorded) {
  auto color =
      image::decode_color(recorded.color_bytes, {recorded.depth.width, recorded.depth.height});
  if (!color.ok()) return in_context("colour image", color.error());
  return frame::RgbdFrame{recorded.timestamp_s, std::move(recorded.depth), std::move(*color),
                          recorded.acceleration_m_s2};
}

}  // namespace hermite::dataset
