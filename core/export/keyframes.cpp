#include "core/export/keyframes.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "core/dataset/trajectory_formats.h"

namespace hermite::exports {
namespace {

constexpr double kSpacingGrowth = 1.25;
constexpr int kMostGrowths = 60;  // to 70 km

bool is_near(const SeenFrame& a, const SeenFrame& b, double spacing_m, double spacing_rad) {
  return (a.world_from_camera.translation - b.world_from_camera.translation).norm() < spacing_m &&
         angle_rad(a.world_from_camera.rotation.conjugate() * b.world_from_camera.rotation) <
             spacing_rad;
}

std::vector<SeenFrame> choose_apart(const std::vector<SeenFrame>& frames, double spacing_m,
                                    double spacing_rad, int window_frames) {
  std::vector<SeenFrame> chosen;
  const auto is_apart = [&](const SeenFrame& frame) {
    return std::none_of(chosen.begin(), chosen.end(), [&](const SeenFrame& other) {
      return is_near(frame, other, spacing_m, spacing_rad);
    });
  };
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!is_apart(frames[i])) continue;
    std::size_t best = i;
    for (std::size_t k = i + 1;
         k < std::min(frames.size(), i + static_cast<std::size_t>(window_frames)); ++k)
      if (frames[k].sharpness > frames[best].sharpness && is_apart(frames[k])) best = k;
    chosen.push_back(frames[best]);
    i = best;
  }
  return chosen;
}

}  // namespace

double sharpness(const ColorImage& image) {
  if (image.width < 3 || image.height < 3) return 0;
  const auto brightness = [&image](int x, int y) {
    const Rgb8& pixel = image.at(x, y);
    return 299 * pixel.r + 587 * pixel.g + 114 * pixel.b;  // luma of Rec. 601, times 1000
  };
  double sum = 0, square_sum = 0;
  for (int y = 1; y + 1 < image.height; ++y)
    for (int x = 1; x + 1 < image.width; ++x) {
      const double laplacian = (brightness(x - 1, y) + brightness(x + 1, y) + brightness(x, y - 1) +
                                brightness(x, y + 1) - 4 * brightness(x, y)) /
                               1000.0;
      sum += laplacian;
      square_sum += laplacian * laplacian;
    }
  const double count = static_cast<double>(image.width - 2) * (image.height - 2),
               mean = sum / count;
  return square_sum / count - mean * mean;
}

std::vector<SeenFrame> choose_keyframes(const std::vector<SeenFrame>& frames,
                                        const KeyframeOptions& options) {
  double spacing_m = options.spacing_m, spacing_rad = options.spacing_deg * M_PI / 180;
  for (int growths = 0;; ++growths) {
    std::vector<SeenFrame> chosen =
        choose_apart(frames, spacing_m, spacing_rad, options.window_frames);
    if (chosen.size() <= options.most) return chosen;
    if (growths == kMostGrowths) {
      chosen.resize(options.most);
      return chosen;
    }
    spacing_m *= kSpacingGrowth;
    spacing_rad *= kSpacingGrowth;
  }
}

Result<std::vector<SeenFrame>> frames_with_poses(const dataset::Sequence& sequence,
                                                 const dataset::Trajectory& trajectory) {
  const std::vector<bool> tracked = dataset::tracked_frames(trajectory);
  std::vector<SeenFrame> frames;
  std::size_t at = 0;
  for (std::int64_t i = 0; i < sequence.frame_count(); ++i) {
    const double time_s = sequence.timestamp_s(i);
    while (at < trajectory.size() && trajectory[at].timestamp_s < time_s - dataset::kSameTime_s)
      ++at;
    if (at == trajectory.size()) break;
    if (trajectory[at].timestamp_s <= time_s + dataset::kSameTime_s && tracked[at])
      frames.push_back({i, trajectory[at].world_from_camera, 0});
  }
  if (frames.empty())
    return Error{ErrorCode::kNotFound,
                 fmt::format("none of the {} frames of {} has one of the trajectory's {} poses: "
                             "their timestamps must agree within 0.1 ms",
                             sequence.frame_count(), sequence.name(), trajectory.size())};
  return frames;
}

Result<std::vector<SeenFrame>> find_keyframes(const dataset::Sequence& sequence,
                                              std::vector<SeenFrame> frames,
                                              const KeyframeOptions& options,
                                              const ExportProgress& progress) {
  std::vector<SeenFrame> readable;
  std::string problem;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!progress(static_cast<std::int64_t>(i), static_cast<std::int64_t>(frames.size())))
      return ended_early();
    Result<dataset::RecordedFrame> recorded = sequence.read(frames[i].index);
    Result<frame::RgbdFrame> frame = recorded.ok() ? dataset::decode_frame(*std::move(recorded))
                                                   : Result<frame::RgbdFrame>(recorded.error());
    if (!frame.ok()) {
      problem = frame.error().message;
      continue;
    }
    frames[i].sharpness = sharpness(frame->color);
    readable.push_back(frames[i]);
  }
  if (readable.empty())
    return Error{ErrorCode::kNotFound, "none of the frames with a pose could be read: " + problem};
  return choose_keyframes(readable, options);
}

Error ended_early() { return {ErrorCode::kBusy, "the export was stopped before it was complete"}; }

}  // namespace hermite::exports
