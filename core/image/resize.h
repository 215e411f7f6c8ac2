// Colour images of another size than the depth images beside them. Pure and thread-safe.
#pragma once

#include "core/base/image.h"
#include "core/image/image_codec.h"

namespace hermite::image {

// Each new pixel is the mean of the area it covers, so that nothing aliases. Image borders stay
// borders: what was at pixel u is afterwards at (u + 0.5) * new width / old width - 0.5. CHECK:
// neither size is empty.
ColorImage resize_color(const ColorImage& image, ImageSize size);

}  // namespace hermite::image
