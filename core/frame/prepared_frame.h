// A frame prepared for processing on the GPU: everything that can be done before is done. Plain
// value.
#pragma once

#include <cstdint>
#include <optional>

#include "core/frame/depth_steps.h"
#include "core/frame/frame_content.h"
#include "core/frame/image_features.h"
#include "core/frame/repeated_rows.h"
#include "core/frame/rgbd_frame.h"
#include "core/frame/sensor_noise.h"

namespace hermite::frame {

struct PreparedFrame {
  // Frame of rectified(camera): rectified, colour registered to depth.
  RgbdFrame frame;
  std::optional<RgbdFrame> as_it_came;  // set when it differs from `frame`
  FrameContent content;                 // of the frame as recorded
  NoiseSample noise;                    // of the depth as recorded
  DepthSteps steps;                     // likewise
  RowDigests rows;                      // likewise
  double repeated_share = 0;            // share of the rows that were removed (repeated_rows.h)
  ImageFeatures features;
  // Index among the cameras that the pipeline has had (core/pipeline/frame_preparer.h).
  std::uint32_t camera_number = 0;
};

}  // namespace hermite::frame
