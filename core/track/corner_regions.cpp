#include "core/track/corner_regions.h"

#include <cmath>

namespace hermite::track {

namespace {

// A corner votes for the pixels around it on its surface, with a Gaussian weight of this standard
// deviation and up to this distance, in coarse pixels; corners are two of these apart.
constexpr double kSpeaksFor_px = 4;
constexpr int kHeard_px = 12;
// More than two full votes are needed, so about three corners nearby, since some are followed
// wrongly.
constexpr double kLeastVotes = 2;
// Where a surface is too small to be numbered, pixels nearby whose depth differs by less than this
// are taken to be the same object.
constexpr double kSameDepth_m = 0.15;
// If nearly all corners of a surface move and they are spread all over it, all of it moves, for
// example a plate that turns on a table without corners of its own.
constexpr int kSpeakForAll = 4;
constexpr double kNearlyAll = 0.75, kAllOver = 0.8, kHeard = 0.1;

struct Placed {
  int x, y;
  std::uint32_t surface;
  float depth_m;
  bool moves;
};

std::vector<Placed> placed(const frame::CoarseView& view, const ViewSurfaces& surfaces,
                           const std::vector<SeenCorner>& corners, int image_width) {
  std::vector<Placed> result;
  const double scale = static_cast<double>(view.camera.width) / image_width;
  for (const SeenCorner& corner : corners) {
    const int x = static_cast<int>(scale * (corner.pixel.x() + 0.5)),
              y = static_cast<int>(scale * (corner.pixel.y() + 0.5));
    if (!view.contains(x, y) || view.depth_m[view.index(x, y)] <= 0) continue;
    result.push_back(
        {x, y, surfaces.of_pixel[view.index(x, y)], view.depth_m[view.index(x, y)], corner.moves});
  }
  return result;
}

}  // namespace

frame::CoarseMask regions_of_corners(const frame::CoarseView& view, const ViewSurfaces& surfaces,
                                     const std::vector<SeenCorner>& corners, int image_width) {
  frame::CoarseMask mask(view.size(), 0);
  std::vector<double> moving(view.size(), 0), resting(view.size(), 0);
  std::vector<int> moving_of(surfaces.pixel_count.size(), 0),
      all_of(surfaces.pixel_count.size(), 0);
  for (const Placed& corner : placed(view, surfaces, corners, image_width)) {
    moving_of[corner.surface] += corner.moves ? 1 : 0;
    ++all_of[corner.surface];
    for (int y = corner.y - kHeard_px; y <= corner.y + kHeard_px; ++y)
      for (int x = corner.x - kHeard_px; x <= corner.x + kHeard_px; ++x) {
        if (!view.contains(x, y)) continue;
        const std::size_t i = view.index(x, y);
        if (view.depth_m[i] <= 0) continue;
        const bool numbered = corner.surface != 0 && surfaces.of_pixel[i] != 0;
        const bool same = numbered
                              ? corner.surface == surfaces.of_pixel[i]
                              : std::abs(double{view.depth_m[i] - corner.depth_m}) < kSameDepth_m;
        if (!same) continue;
        const double way2 = std::pow(x - corner.x, 2) + std::pow(y - corner.y, 2);
        (corner.moves ? moving : resting)[i] +=
            std::exp(-way2 / (2 * kSpeaksFor_px * kSpeaksFor_px));
      }
  }
  std::vector<std::size_t> heard_of(surfaces.pixel_count.size(), 0);
  for (std::size_t i = 0; i < view.size(); ++i)
    heard_of[surfaces.of_pixel[i]] += moving[i] > kHeard ? 1 : 0;
  for (std::size_t i = 0; i < view.size(); ++i) {
    const std::uint32_t surface = surfaces.of_pixel[i];
    const bool all = surface != 0 && moving_of[surface] >= kSpeakForAll &&
                     moving_of[surface] >= kNearlyAll * all_of[surface] &&
                     static_cast<double>(heard_of[surface]) >=
                         kAllOver * static_cast<double>(surfaces.pixel_count[surface]);
    mask[i] = all || (moving[i] > kLeastVotes && moving[i] > resting[i]) ? 1 : 0;
  }
  return mask;
}

}  // namespace hermite::track
