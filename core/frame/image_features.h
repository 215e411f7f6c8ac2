// Features for image motion: a pyramid of grey images, and corners with their depth. Runs on the
// host.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/frame/frame_options.h"
#include "core/frame/rgbd_frame.h"

namespace hermite::frame {

struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // row major

  std::uint8_t at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(x)];
  }
};

struct Corner {
  float x = 0, y = 0;  // pixels of levels[0]; centres are integers
  float depth_m = 0;   // 0: unknown
};

struct ImageFeatures {
  int image_px = 1;               // image pixels per pixel of levels[0], in each direction
  std::vector<GreyImage> levels;  // each has half the size of the one before
  std::vector<Corner> corners;    // at most one per 16x16 pixels of levels[0]
};

// Detects features; depths are within the options' range. Takes about 3 ms for 640x480. Any thread.
ImageFeatures features_of(const RgbdFrame& frame, double depth_units_per_metre,
                          const FrameOptions& options);

// Returns the median depth [m] of the 3x3 pixels around a pixel; 0 if less than half of them have a
// depth in the options' range.
float depth_around(const DepthImage& depth, int x, int y, double units_per_metre,
                   const FrameOptions& options);

void save(ByteWriter& bytes, const ImageFeatures& features);
// The reader fails when the numbers of pixels are inconsistent.
void restore(ByteReader& bytes, ImageFeatures& features);

}  // namespace hermite::frame
