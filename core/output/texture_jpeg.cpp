#include "core/output/texture_jpeg.h"

#include "core/image/image_codec.h"

namespace hermite::output {
namespace {

constexpr int kTextureQuality = 92;  // block artefacts are not visible, and text stays sharp

}  // namespace

Result<std::string> texture_jpeg(const ColorImage& image) {
  const Result<std::vector<std::uint8_t>> bytes =
      image::encode_jpeg(image, kTextureQuality, image::JpegColor::kFull);
  if (!bytes.ok()) return bytes.error();
  return std::string(bytes->begin(), bytes->end());
}

}  // namespace hermite::output
