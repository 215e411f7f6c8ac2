// Statistics of a frame before any processing, from which the reason can be given when it cannot be
// used.
#pragma once

#include <cstdint>

#include "core/frame/frame_options.h"
#include "core/frame/rgbd_frame.h"

namespace hermite::frame {

// Ratios are of all pixels, 0 to 1.
struct FrameContent {
  double in_range = 0;   // depth between the options' limits
  double too_near = 0;   // measured, but nearer
  double too_far = 0;    // measured, but farther
  double median_m = 0;   // of the depths in range; 0 without any
  double mean_grey = 0;  // 0 to 255
  double texture = 0;    // mean absolute difference of grey values between neighbouring pixels
  // Digest of all depth pixels; sensor noise makes it different for every measurement. 0: no depth.
  std::uint64_t depth_digest = 0;
};

// Samples every fourth pixel in both directions, except for the digest; takes below a millisecond.
// Any thread. Both images have the same size.
FrameContent content_of(const RgbdFrame& frame, double depth_units_per_metre,
                        const FrameOptions& options);

}  // namespace hermite::frame
