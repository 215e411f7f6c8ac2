// Changes of image brightness by light and lens, for tests of tracking by colour; depth and ground
// truth are unchanged.
//
// Appended to any source (open_sequence), with or without options:
//   +exposure    gain 1 + amplitude * sin(2 pi t / period_s), t from the first frame
//     amplitude  0 to 0.9 (0.25)
//     period_s   0.01 to 3600 (2)
//   +flicker     a gain per frame, uniformly distributed from 1 - amplitude to 1 + amplitude
//     amplitude  0 to 0.9 (0.1)
//     seed       0 to 2^63 - 1 (1)
//   +vignetting  gain 1 in the middle, falling with the square of the distance from it
//     corner     0 to 1 (0.55)   gain in the corners
// Gains apply to the sRGB bytes; results are clamped to 0 to 255. The colour becomes a JPEG.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

// `options` is "key=value,..." or empty. kInvalidArgument, naming key and range.
Result<std::unique_ptr<dataset::Sequence>> with_exposure(
    std::unique_ptr<dataset::Sequence> sequence, const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_flicker(std::unique_ptr<dataset::Sequence> sequence,
                                                        const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_vignetting(
    std::unique_ptr<dataset::Sequence> sequence, const std::string& options);

// Returns the pixel with each channel times its gain, rounded and clamped.
Rgb8 multiplied(const Rgb8& pixel, double red, double green, double blue);
inline Rgb8 multiplied(const Rgb8& pixel, double gain) {
  return multiplied(pixel, gain, gain, gain);
}

// Returns the squared distance of a pixel from the middle of the image, 1 in the corners, on which
// lens effects depend.
double squared_radius(int x, int y, int width, int height);

}  // namespace hermite::disturb
