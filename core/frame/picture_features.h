// What the motion between two pictures is told by: a pyramid of grey values, and corners with their depth. Host only, no GPU.
#pragma once

#include <cstdint>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/frame/frame_options.h"
#include "core/frame/rgbd_frame.h"

namespace hermite {

struct GreyImage {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  // row major

  std::uint8_t at(int x, int y) const {
    return pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)];
  }
};

struct Corner {
  float x = 0, y = 0;  // pixels of levels[0], centres are integers
  float depth_m = 0;   // 0: unknown
};

struct PictureFeatures {
  int image_px = 1;               // so many pixels of the image, in each direction, are one of levels[0]
  std::vector<GreyImage> levels;  // each of half the size of the one before
  std::vector<Corner> corners;    // at most one for 16x16 pixels of levels[0]
};

// Depths are within the options' range. Some 3 ms for 640x480. Any thread.
PictureFeatures features_of(const RgbdFrame& frame, double depth_units_per_metre, const FrameOptions& options);

// The median of what is measured in 3x3 pixels around one [m]; 0 where that is less than half, or out of the options' range.
float depth_around(const DepthImage& depth, int x, int y, double units_per_metre, const FrameOptions& options);

void save(ByteWriter& bytes, const PictureFeatures& features);
// kCorrupt by the reader when the numbers of pixels do not fit each other.
void restore(ByteReader& bytes, PictureFeatures& features);

}  // namespace hermite
