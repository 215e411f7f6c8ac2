#include "core/track/view_surfaces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/frame/frame_options.h"

namespace hermite::track {

namespace {

// Share of the pixels; smaller ones are edges or reflections, or have too few pairs.
constexpr double kLeastSurface = 0.01;

// Two pixels are on one surface if one lies this close to the plane of the other, in standard
// deviations and as a share of their distance, and if the surface does not bend towards the camera
// by more than this angle between them: 30 degrees, four times the noise of a coarse pixel's
// normal.
constexpr double kStep = 3, kSlope = 0.15, kConcaveCosine = 0.87;

bool is_continued(const frame::CoarseView& view, std::size_t from, const Eigen::Vector3d& point,
                  std::size_t to, const Eigen::Vector3d& next) {
  const Eigen::Vector3d normal = view.normals[from].cast<double>(),
                        next_normal = view.normals[to].cast<double>(), way = next - point;
  const double off_m = std::min(std::abs(normal.dot(way)), std::abs(next_normal.dot(way)));
  if (off_m > kStep * frame::kinect_noise_m(point.z()) + kSlope * way.norm()) return false;
  return normal.dot(next_normal) > kConcaveCosine || way.dot(next_normal - normal) < 0;
}

}  // namespace

ViewSurfaces surfaces_of(const frame::CoarseView& view) {
  constexpr std::uint32_t kUnvisited = ~0u;
  const auto least_pixels =
      static_cast<std::size_t>(std::ceil(kLeastSurface * static_cast<double>(view.size())));
  ViewSurfaces surfaces{std::vector<std::uint32_t>(view.size(), kUnvisited), {0}};
  const auto width = static_cast<std::size_t>(view.camera.width);
  std::vector<std::size_t> region;
  for (std::size_t start = 0; start < view.size(); ++start) {
    if (surfaces.of_pixel[start] != kUnvisited) continue;
    const auto number = static_cast<std::uint32_t>(surfaces.pixel_count.size());
    region.assign(1, start);
    surfaces.of_pixel[start] = view.depth_m[start] > 0 ? number : 0;
    for (std::size_t next = 0; next < region.size() && view.depth_m[start] > 0; ++next) {
      const int x = static_cast<int>(region[next] % width),
                y = static_cast<int>(region[next] / width);
      for (const auto& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        if (!view.contains(x + dx, y + dy)) continue;
        const std::size_t i = view.index(x + dx, y + dy);
        if (surfaces.of_pixel[i] != kUnvisited || view.depth_m[i] <= 0) continue;
        if (!is_continued(view, region[next], view.point(x, y), i, view.point(x + dx, y + dy)))
          continue;
        surfaces.of_pixel[i] = number;
        region.push_back(i);
      }
    }
    if (view.depth_m[start] > 0 && region.size() >= least_pixels) {
      surfaces.pixel_count.push_back(region.size());
      continue;
    }
    for (const std::size_t i : region) surfaces.of_pixel[i] = 0;
    surfaces.pixel_count[0] += region.size();
  }
  return surfaces;
}

}  // namespace hermite::track
