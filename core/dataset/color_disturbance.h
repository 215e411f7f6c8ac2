// What light and lens do to the brightness of a picture. For tests of tracking by colour; depth and ground truth stay as they are.
//
// Written behind any source (open_sequence), with or without options:
//   +exposure    gain 1 + amplitude * sin(2 pi t / period_s), t from the first frame
//     amplitude  0 to 0.9 (0.25)
//     period_s   0.01 to 3600 (2)
//   +flicker     a gain of each frame, evenly spread from 1 - amplitude to 1 + amplitude
//     amplitude  0 to 0.9 (0.1)
//     seed       0 to 2^63 - 1 (1)
//   +vignetting  gain 1 in the middle, falling with the square of the distance from it
//     corner     0 to 1 (0.55)   gain in the corners
// Gains are of the bytes as they are, sRGB; what leaves 0 to 255 is cut. The colour becomes a JPEG.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite {

// `options` is "key=value,...", may be empty. kInvalidArgument, naming key and range.
Result<std::unique_ptr<Sequence>> with_exposure(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_flicker(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_vignetting(std::unique_ptr<Sequence> sequence, const std::string& options);

// Square of the distance of a pixel from the middle of the image, 1 in the corners: what lenses depend on.
double squared_radius(int x, int y, int width, int height);

}  // namespace hermite
