#include "core/pipeline/frame_preparer.h"

#include <string>
#include <utility>

namespace hermite {

FramePreparer::FramePreparer(const Camera& camera, const Options& options, std::uint32_t number)
    : camera_(camera), options_(options), number_(number), rectifier_(rectifier_of(camera)) {}

Status FramePreparer::check(const RgbdFrame& frame) const {
  const auto fits = [this](int width, int height) { return width == camera_.width && height == camera_.height; };
  if (fits(frame.depth.width, frame.depth.height) && fits(frame.color.width, frame.color.height)) return Done{};
  const auto size = [](int width, int height) { return std::to_string(width) + "x" + std::to_string(height); };
  return Error{ErrorCode::kInvalidArgument, "the frame is " + size(frame.depth.width, frame.depth.height) + " depth and " +
                                                size(frame.color.width, frame.color.height) + " colour, but the camera is " +
                                                size(camera_.width, camera_.height)};
}

PreparedFrame FramePreparer::prepare(RgbdFrame frame) const {
  PreparedFrame prepared;
  prepared.camera_number = number_;
  prepared.content = content_of(frame, camera_.depth_units_per_metre, options_.frame);
  prepared.noise = measure_noise(frame.depth, camera_.depth_units_per_metre, options_.frame);
  prepared.steps = measure_steps(frame.depth, camera_.depth_units_per_metre);
  if (rectifier_) {
    prepared.frame = rectifier_->apply(frame);
    prepared.as_it_came = std::move(frame);
  } else {
    prepared.frame = std::move(frame);
  }
  prepared.features = features_of(prepared.frame, camera_.depth_units_per_metre, options_.frame);
  return prepared;
}

PreparedFrame FramePreparer::prepare_again(const PreparedFrame& prepared) const {
  return prepare(prepared.as_it_came ? *prepared.as_it_came : prepared.frame);
}

PreparedFrame FramePreparer::empty(double timestamp_s) const {
  return prepare({timestamp_s, DepthImage(camera_.width, camera_.height), ColorImage(camera_.width, camera_.height)});
}

}  // namespace hermite
