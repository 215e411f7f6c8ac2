// A frame that waits for its turn on the device: all that can be done with it before is done. Plain value.
#pragma once

#include <cstdint>
#include <optional>

#include "core/frame/frame_content.h"
#include "core/frame/picture_features.h"
#include "core/frame/rgbd_frame.h"
#include "core/frame/sensor_noise.h"

namespace hermite {

struct PreparedFrame {
  RgbdFrame frame;                      // of rectified(camera): straight, colour registered to depth
  std::optional<RgbdFrame> as_it_came;  // where that is another one
  FrameContent content;                 // of the frame as it came
  NoiseSample noise;                    // of its depth as it came
  PictureFeatures features;
  std::uint32_t camera_number = 0;  // of those that the pipeline has had so far (core/pipeline/frame_preparer.h)
};

}  // namespace hermite
