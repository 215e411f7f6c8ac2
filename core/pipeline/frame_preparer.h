// Preparation of frames for one camera before the GPU processes them. Const functions are
// thread-safe.
#pragma once

#include <cstdint>
#include <optional>

#include "core/base/result.h"
#include "core/frame/prepared_frame.h"
#include "core/frame/rectify.h"
#include "core/math/camera.h"
#include "core/pipeline/options.h"

namespace hermite::pipeline {

class FramePreparer {
 public:
  // `number` identifies the camera within one pipeline.
  FramePreparer(const Camera& camera, const Options& options, std::uint32_t number);

  const Camera& camera() const { return camera_; }
  std::uint32_t number() const { return number_; }

  // Returns kInvalidArgument when the frame has another size than the camera.
  Status check(const frame::RgbdFrame& frame) const;

  // Rectifies and registers the frame, repairs its depth, and detects its features. The frame has
  // the camera's size.
  frame::PreparedFrame prepare(frame::RgbdFrame frame) const;

  // Prepares a frame again: for this camera, if it was prepared for another one, and without its
  // last `removed_row_count` rows (core/frame/repeated_rows.h).
  frame::PreparedFrame prepare_again(const frame::PreparedFrame& prepared,
                                     int removed_row_count) const;

  // Returns a prepared frame without any content.
  frame::PreparedFrame empty(double timestamp_s) const;

 private:
  const Camera camera_;
  const Options options_;
  const std::uint32_t number_;
  // Set when frames do not arrive rectified and registered.
  const std::optional<frame::Rectifier> rectifier_;
};

}  // namespace hermite::pipeline
