#include "core/texture/texture_options.h"

#include <fmt/core.h>

#include <string>

namespace hermite::texture {

namespace {

Status check_range(const char* field, double value, double low, double high) {
  if (value >= low && value <= high) return Done{};  // written so that NaN fails
  const auto text = [](double number) {
    std::string digits = std::to_string(number);
    digits.erase(digits.find_last_not_of('0') + 1);
    if (digits.back() == '.') digits.pop_back();
    return digits;
  };
  return Error{ErrorCode::kInvalidArgument, fmt::format("{} is {}, allowed are {} to {}", field,
                                                        text(value), text(low), text(high))};
}

}  // namespace

Status validate(const TextureOptions& options) {
  const struct {
    const char* field;
    double value, low, high;
  } ranges[] = {{"texel_m", options.texel_m, 0.0002, 0.1},
                {"page_px", static_cast<double>(options.page_px), 256, 8192},
                {"max_pages", static_cast<double>(options.max_pages), 1, 64},
                {"max_views", static_cast<double>(options.max_views), 1, 1000},
                {"view_step_m", options.view_step_m, 0.001, 10},
                {"view_turn_deg", options.view_turn_deg, 0.1, 180},
                {"blended_views", static_cast<double>(options.blended_views), 1, 8},
                {"thread_count", static_cast<double>(options.thread_count), 0, 1024}};
  for (const auto& range : ranges)
    if (Status checked = check_range(range.field, range.value, range.low, range.high);
        !checked.ok())
      return checked;
  return Done{};
}

Status validate(const TextureFrames& frames) {
  if (Status camera = validate(frames.camera); !camera.ok()) return camera;
  if (!(rectified(frames.camera) == frames.camera))
    return Error{ErrorCode::kInvalidArgument,
                 "the frames have lens distortion or a separate colour camera: rectify them first"};
  if (!frames.read)
    return Error{ErrorCode::kInvalidArgument, "the frames have no function that reads them"};
  const Image<std::uint8_t>& seen = frames.is_seen;
  if (!seen.pixels.empty() &&
      (seen.width != frames.camera.width || seen.height != frames.camera.height))
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("is_seen is {}x{}, the camera's images are {}x{}", seen.width,
                             seen.height, frames.camera.width, frames.camera.height)};
  for (std::size_t i = 0; i < frames.world_from_camera.size(); ++i)
    if (frames.world_from_camera[i] && !is_finite(*frames.world_from_camera[i]))
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("the pose of frame {} is not finite", i)};
  return Done{};
}

}  // namespace hermite::texture
