#include "core/export/texture_frames.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "core/dataset/trajectory_formats.h"
#include "core/frame/rectify.h"

namespace hermite::exports {

namespace {

// Returns the camera that took the colour images.
Camera color_camera_of(const Camera& camera) {
  Camera color = camera;
  color.depth_correction = {};
  color.color.reset();
  if (camera.color) {
    color.fx = camera.color->fx;
    color.fy = camera.color->fy;
    color.cx = camera.color->cx;
    color.cy = camera.color->cy;
    color.distortion = camera.color->distortion;
  }
  return color;
}

// Returns 0 for pixels of the rectified image that are outside the original image.
Image<std::uint8_t> seen_pixels(const Camera& color_camera) {
  if (color_camera.distortion == Distortion{}) return {};
  Image<std::uint8_t> is_seen(color_camera.width, color_camera.height);
  for (int y = 0; y < color_camera.height; ++y)
    for (int x = 0; x < color_camera.width; ++x) {
      const Eigen::Vector2d at = color_camera.distort(x, y);
      is_seen.at(x, y) = at.x() >= 0 && at.y() >= 0 && at.x() <= color_camera.width - 1 &&
                                 at.y() <= color_camera.height - 1
                             ? 1
                             : 0;
    }
  return is_seen;
}

// Removes lost frames, which have the last pose before them in a trajectory.
dataset::Trajectory without_lost(const dataset::Trajectory& trajectory) {
  const std::vector<bool> is_tracked = dataset::tracked_frames(trajectory);
  dataset::Trajectory tracked;
  for (std::size_t i = 0; i < trajectory.size(); ++i)
    if (is_tracked[i]) tracked.push_back(trajectory[i]);
  return tracked;
}

}  // namespace

texture::TextureFrames texture_frames_of(const dataset::Sequence& sequence,
                                         const dataset::Trajectory& trajectory) {
  const Camera color_camera = color_camera_of(sequence.camera());
  const Rigid3 depth_from_color =
      sequence.camera().color ? inverse(sequence.camera().color->color_from_depth) : Rigid3();
  texture::TextureFrames frames;
  frames.camera = rectified(color_camera);
  frames.is_seen = seen_pixels(color_camera);
  const dataset::Trajectory tracked = without_lost(trajectory);
  for (std::int64_t i = 0; i < sequence.frame_count(); ++i) {
    const std::optional<Rigid3> world_from_camera =
        dataset::pose_at(tracked, sequence.timestamp_s(i), dataset::kSameTime_s);
    frames.world_from_camera.push_back(
        world_from_camera ? std::optional<Rigid3>(*world_from_camera * depth_from_color)
                          : std::nullopt);
  }
  const std::shared_ptr<const std::optional<frame::Rectifier>> rectifier =
      std::make_shared<const std::optional<frame::Rectifier>>(frame::rectifier_of(color_camera));
  frames.read = [&sequence, rectifier](std::size_t index) -> Result<ColorImage> {
    Result<dataset::RecordedFrame> recorded = sequence.read(static_cast<std::int64_t>(index));
    if (!recorded.ok()) return recorded.error();
    Result<frame::RgbdFrame> frame = dataset::decode_frame(*std::move(recorded));
    if (!frame.ok()) return frame.error();
    return *rectifier ? (*rectifier)->apply(*frame).color : std::move(frame->color);
  };
  return frames;
}

}  // namespace hermite::exports
