// Encodes a texture page as JPEG. Pure.
#pragma once

#include <string>

#include "core/base/image.h"
#include "core/base/result.h"

namespace hermite::output {

// Encodes sRGB with 4:4:4, because charts are neighbours in a page and chroma subsampling would mix
// their colours. Returns kInvalidArgument above kMaxImageEdge_px.
Result<std::string> texture_jpeg(const ColorImage& image);

}  // namespace hermite::output
