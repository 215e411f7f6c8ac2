// A page of a texture as bytes of a file. Pure.
#pragma once

#include <string>

#include "core/base/image.h"
#include "core/base/result.h"

namespace hermite {

// sRGB, 4:4:4: charts lie side by side in a page, and half of the colour's resolution would carry one's into the other. kInvalidArgument:
// larger than kMaxImageEdge_px.
Result<std::string> texture_jpeg(const ColorImage& image);

}  // namespace hermite
