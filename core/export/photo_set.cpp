#include "core/export/photo_set.h"

#include "core/base/printf_text.h"
#include "core/image/image_codec.h"

namespace hermite {

PictureReader::PictureReader(const Sequence& sequence) : sequence_(sequence), rectifier_(rectifier_of(sequence.camera())) {}

Result<Picture> PictureReader::read(std::int64_t index) const {
  Result<RecordedFrame> recorded = sequence_.read(index);
  if (!recorded.ok()) return recorded.error();
  Picture picture;
  if (!rectifier_) picture.color_bytes = recorded->color_bytes;
  Result<RgbdFrame> frame = decode_frame(*std::move(recorded));
  if (!frame.ok()) return frame.error();
  picture.frame = rectifier_ ? rectifier_->apply(*frame) : *std::move(frame);
  if (rectifier_) {
    Result<std::vector<std::uint8_t>> png = encode_png(picture.frame.color);
    if (!png.ok()) return png.error();
    picture.color_bytes = *std::move(png);
  }
  const Result<ImageFormat> format = detect_image_format(picture.color_bytes);
  if (!format.ok()) return format.error();
  picture.name = printf_text("frame_%06lld.%s", static_cast<long long>(index), *format == ImageFormat::kJpeg ? "jpg" : "png");
  return picture;
}

}  // namespace hermite
