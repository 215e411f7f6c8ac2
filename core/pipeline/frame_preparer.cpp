#include "core/pipeline/frame_preparer.h"

#include <fmt/core.h>

#include <string>
#include <utility>

#include "core/frame/repaired_depth.h"

namespace hermite::pipeline {

FramePreparer::FramePreparer(const Camera& camera, const Options& options, std::uint32_t number)
    : camera_(camera),
      options_(options),
      number_(number),
      rectifier_(frame::rectifier_of(camera)) {}

Status FramePreparer::check(const frame::RgbdFrame& frame) const {
  const auto fits = [this](int width, int height) {
    return width == camera_.width && height == camera_.height;
  };
  if (fits(frame.depth.width, frame.depth.height) && fits(frame.color.width, frame.color.height))
    return Done{};
  const auto size = [](int width, int height) { return fmt::format("{}x{}", width, height); };
  return Error{ErrorCode::kInvalidArgument,
               fmt::format("the frame is {} depth and {} colour, but the camera is {}",
                           size(frame.depth.width, frame.depth.height),
                           size(frame.color.width, frame.color.height),
                           size(camera_.width, camera_.height))};
}

frame::PreparedFrame FramePreparer::prepare(frame::RgbdFrame frame) const {
  frame::PreparedFrame prepared;
  prepared.camera_number = number_;
  prepared.content = frame::content_of(frame, camera_.depth_units_per_metre, options_.frame);
  prepared.noise = frame::measure_noise(frame.depth, camera_.depth_units_per_metre, options_.frame);
  prepared.steps = frame::measure_steps(frame.depth, camera_.depth_units_per_metre);
  prepared.rows = frame::digest_rows(frame.depth);
  prepared.frame = rectifier_ ? rectifier_->apply(frame) : frame;
  const bool is_repaired =
      frame::repair_depth(prepared.frame.depth, camera_.depth_units_per_metre, options_.frame);
  if (rectifier_ || is_repaired) prepared.as_it_came = std::move(frame);
  prepared.features =
      frame::features_of(prepared.frame, camera_.depth_units_per_metre, options_.frame);
  return prepared;
}

frame::PreparedFrame FramePreparer::prepare_again(const frame::PreparedFrame& prepared,
                                                  int removed_row_count) const {
  frame::RgbdFrame frame = prepared.as_it_came ? *prepared.as_it_came : prepared.frame;
  if (removed_row_count > 0) frame::remove_last_rows(frame, removed_row_count);
  return prepare(std::move(frame));
}

frame::PreparedFrame FramePreparer::empty(double timestamp_s) const {
  return prepare({timestamp_s, DepthImage(camera_.width, camera_.height),
                  ColorImage(camera_.width, camera_.height)});
}

}  // namespace hermite::pipeline
