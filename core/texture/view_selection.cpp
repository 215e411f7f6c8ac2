#include "core/texture/view_selection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/parallel.h"
#include "core/texture/view_raster.h"

namespace hermite::texture {

namespace {

// Images read to measure their sharpness.
constexpr std::size_t kReadPerWindow = 4, kReadInAll = 6000;
// The distance at which image motion is computed.
constexpr double kUsualDepth_m = 2;
// Approximate width of the images in which coverage is computed.
constexpr int kCoarseWidth_px = 80;
constexpr std::size_t kCoarseTriangles = 100'000;  // by number, in groups of adjacent triangles
constexpr std::size_t kMaxCandidates = 2000;

struct ViewCandidate {
  std::size_t frame = 0;
  double sharpness = 0;
};

bool is_another(const Rigid3& a, const Rigid3& b, const TextureOptions& options) {
  const double turn_rad = angle_rad(a.rotation.conjugate() * b.rotation);
  return (a.translation - b.translation).norm() >= options.view_step_m ||
         turn_rad >= options.view_turn_deg * std::numbers::pi / 180;
}

// Returns runs of frames with about the same view, without lost frames.
std::vector<std::vector<std::size_t>> windows_of(const TextureFrames& frames,
                                                 const TextureOptions& options) {
  std::vector<std::vector<std::size_t>> windows;
  for (std::size_t i = 0; i < frames.world_from_camera.size(); ++i) {
    if (!frames.world_from_camera[i]) continue;
    if (windows.empty() || is_another(*frames.world_from_camera[windows.back().front()],
                                      *frames.world_from_camera[i], options))
      windows.emplace_back();
    windows.back().push_back(i);
  }
  return windows;
}

// Returns the sharpest of the slowest few; its sharpness is 0 if none could be read.
ViewCandidate sharpest_of(const std::vector<std::size_t>& window, const TextureFrames& frames,
                          std::size_t most_read) {
  std::vector<std::pair<double, std::size_t>> by_blur;
  for (const std::size_t frame : window) by_blur.emplace_back(blur_px(frames, frame), frame);
  std::sort(by_blur.begin(), by_blur.end());
  ViewCandidate best;
  for (std::size_t i = 0; i < std::min(most_read, by_blur.size()); ++i) {
    const Result<ColorImage> image = frames.read(by_blur[i].second);
    if (!image.ok()) continue;
    const double sharpness = laplacian_variance(*image) + 1e-9;
    if (sharpness > best.sharpness) best = {by_blur[i].second, sharpness};
  }
  return best;
}

// Returns candidates by decreasing sharpness, without those too close to one that was taken.
std::vector<ViewCandidate> thinned(std::vector<ViewCandidate> candidates,
                                   const TextureFrames& frames, const TextureOptions& options) {
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const ViewCandidate& a, const ViewCandidate& b) { return a.sharpness > b.sharpness; });
  std::vector<ViewCandidate> kept;
  for (const ViewCandidate& candidate : candidates) {
    const Rigid3& pose = *frames.world_from_camera[candidate.frame];
    if (std::all_of(kept.begin(), kept.end(), [&](const ViewCandidate& other) {
          return is_another(*frames.world_from_camera[other.frame], pose, options);
        }))
      kept.push_back(candidate);
    if (kept.size() == kMaxCandidates) break;
  }
  return kept;
}

// Groups of neighbouring triangles that a frame sees in a coarse image, each once, with how well it
// sees them.
struct CoarseSight {
  std::vector<std::pair<std::uint32_t, float>> groups;
};

CoarseSight coarse_sight(const output::TriangleMesh& mesh, const TextureFrames& frames,
                         std::size_t frame, std::size_t group_size) {
  Camera coarse = frames.camera;
  const double scale = std::min(1.0, static_cast<double>(kCoarseWidth_px) / frames.camera.width);
  coarse.width = std::max(1, static_cast<int>(frames.camera.width * scale));
  coarse.height = std::max(1, static_cast<int>(frames.camera.height * scale));
  coarse.fx *= scale;
  coarse.fy *= scale;
  coarse.cx = (coarse.cx + 0.5) * scale - 0.5;
  coarse.cy = (coarse.cy + 0.5) * scale - 0.5;
  const ViewRaster raster = rasterised(mesh, coarse, *frames.world_from_camera[frame]);
  std::vector<std::pair<std::uint32_t, float>> seen;
  for (std::size_t i = 0; i < raster.triangle.pixels.size(); ++i) {
    if (raster.triangle.pixels[i] == kNoTriangle) continue;
    const float near = std::min(1.0f, raster.inverse_depth_per_m.pixels[i]);
    seen.emplace_back(static_cast<std::uint32_t>(raster.triangle.pixels[i] / group_size),
                      near * near);
  }
  // Sorts by group with the best value first, and keeps only that.
  std::sort(seen.begin(), seen.end(), [](const auto& a, const auto& b) {
    return a.first != b.first ? a.first < b.first : a.second > b.second;
  });
  seen.erase(std::unique(seen.begin(), seen.end(),
                         [](const auto& a, const auto& b) { return a.first == b.first; }),
             seen.end());
  return {std::move(seen)};
}

std::vector<ViewCandidate> spread(const std::vector<ViewCandidate>& candidates,
                                  const output::TriangleMesh& mesh, const TextureFrames& frames,
                                  const TextureOptions& options) {
  const std::size_t group_size = mesh.triangles.size() / kCoarseTriangles + 1;
  std::vector<CoarseSight> sights(candidates.size());
  in_parallel(candidates.size(), options.thread_count, [&](std::size_t i) {
    if (!is_stopped(options))
      sights[i] = coarse_sight(mesh, frames, candidates[i].frame, group_size);
  });
  std::vector<float> seen_before(mesh.triangles.size() / group_size + 1, 0.0f);
  std::vector<bool> is_taken(candidates.size(), false);
  std::vector<ViewCandidate> taken;
  while (taken.size() < static_cast<std::size_t>(options.max_views) &&
         taken.size() < candidates.size()) {
    std::size_t best = candidates.size();
    double best_gain = -1;
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      if (is_taken[i]) continue;
      double gain = 0;
      for (const auto& [group, look] : sights[i].groups)
        gain += static_cast<double>(look / (1 + 8 * seen_before[group] * seen_before[group]));
      if (gain <= best_gain) continue;
      best = i;
      best_gain = gain;
    }
    is_taken[best] = true;
    taken.push_back(candidates[best]);
    for (const auto& [group, look] : sights[best].groups) seen_before[group] += look;
  }
  return taken;
}

}  // namespace

double laplacian_variance(const ColorImage& image) {
  double sum = 0, sum2 = 0;
  for (int y = 1; y + 1 < image.height; ++y)
    for (int x = 1; x + 1 < image.width; ++x) {
      const int laplacian = image.at(x - 1, y).g + image.at(x + 1, y).g + image.at(x, y - 1).g +
                            image.at(x, y + 1).g - 4 * image.at(x, y).g;
      sum += laplacian;
      sum2 += static_cast<double>(laplacian) * laplacian;
    }
  const double count =
      static_cast<double>(std::max(image.width - 2, 0)) * std::max(image.height - 2, 0);
  return count > 0 ? sum2 / count - (sum / count) * (sum / count) : 0;
}

double blur_px(const TextureFrames& frames, std::size_t frame) {
  const auto& poses = frames.world_from_camera;
  const auto way_px = [&](std::size_t a, std::size_t b) {
    if (a >= poses.size() || b >= poses.size() || !poses[a] || !poses[b]) return 0.0;
    const Rigid3 step = inverse(*poses[a]) * *poses[b];
    return frames.camera.fx * (angle_rad(step.rotation) + step.translation.norm() / kUsualDepth_m);
  };
  return std::max(frame > 0 ? way_px(frame - 1, frame) : 0.0, way_px(frame, frame + 1));
}

std::vector<std::size_t> selected_views(const output::TriangleMesh& mesh,
                                        const TextureFrames& frames,
                                        const TextureOptions& options) {
  const std::vector<std::vector<std::size_t>> windows = windows_of(frames, options);
  std::vector<ViewCandidate> sharpest(windows.size());
  const std::size_t most_read = std::clamp<std::size_t>(
      kReadInAll / std::max<std::size_t>(windows.size(), 1), 1, kReadPerWindow);
  in_parallel(windows.size(), options.thread_count, [&](std::size_t i) {
    if (!is_stopped(options)) sharpest[i] = sharpest_of(windows[i], frames, most_read);
  });
  std::erase_if(sharpest, [](const ViewCandidate& candidate) { return candidate.sharpness <= 0; });
  std::vector<ViewCandidate> views = thinned(std::move(sharpest), frames, options);
  if (views.size() > static_cast<std::size_t>(options.max_views))
    views = spread(views, mesh, frames, options);
  std::vector<std::size_t> selected;
  for (const ViewCandidate& view : views) selected.push_back(view.frame);
  std::sort(selected.begin(), selected.end());
  return selected;
}

}  // namespace hermite::texture
