// What a frame shows by itself, before anything is computed from it: enough to say in words why it cannot be used.
#pragma once

#include <cstdint>

#include "core/frame/frame_options.h"
#include "core/frame/rgbd_frame.h"

namespace hermite {

// Shares are of all pixels, 0 to 1.
struct FrameContent {
  double in_range = 0;   // depth between the options' limits
  double too_near = 0;   // measured, but nearer
  double too_far = 0;    // measured, but farther
  double median_m = 0;   // of the depths in range; 0 when there are none
  double mean_grey = 0;  // 0 to 255
  double texture = 0;    // mean change of grey to the next pixel
  // Of all depth pixels: noise sees to it that no two measurements have the same. 0: nothing is measured.
  std::uint64_t depth_digest = 0;
};

// Looks at every fourth pixel in both directions but for the digest: below a millisecond. Any thread; both images have the same size.
FrameContent content_of(const RgbdFrame& frame, double depth_units_per_metre, const FrameOptions& options);

}  // namespace hermite
