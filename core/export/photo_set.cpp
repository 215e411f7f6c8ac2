#include "core/export/photo_set.h"

#include "core/base/printf_text.h"
#include "core/image/image_codec.h"

namespace hermite::exports {

PhotoReader::PhotoReader(const dataset::Sequence& sequence)
    : sequence_(sequence), rectifier_(frame::rectifier_of(sequence.camera())) {}

Result<Photo> PhotoReader::read(std::int64_t index) const {
  Result<dataset::RecordedFrame> recorded = sequence_.read(index);
  if (!recorded.ok()) return recorded.error();
  Photo photo;
  if (!rectifier_) photo.color_bytes = recorded->color_bytes;
  Result<frame::RgbdFrame> frame = dataset::decode_frame(*std::move(recorded));
  if (!frame.ok()) return frame.error();
  photo.frame = rectifier_ ? rectifier_->apply(*frame) : *std::move(frame);
  if (rectifier_) {
    Result<std::vector<std::uint8_t>> png = image::encode_png(photo.frame.color);
    if (!png.ok()) return png.error();
    photo.color_bytes = *std::move(png);
  }
  const Result<image::ImageFormat> format = image::detect_image_format(photo.color_bytes);
  if (!format.ok()) return format.error();
  photo.name = printf_text("frame_%06lld.%s", static_cast<long long>(index),
                           *format == image::ImageFormat::kJpeg ? "jpg" : "png");
  return photo;
}

}  // namespace hermite::exports
