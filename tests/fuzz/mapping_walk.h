// A short scan for the back end: few and small frames, so that all of its state is a short input,
// and drawn by hand, because rendering takes longer than all else under the sanitizers. Header
// only.
#pragma once

#include <cstdint>
#include <memory>

#include "core/adjust/mapping.h"

namespace hermite::fuzz {

// Along a wall, a tenth of the picture from one frame to the next.
inline constexpr std::size_t kSeenFrames = 6;  // before the state is saved
inline constexpr int kStep_px = 10;
inline constexpr double kWall_m = 1.5;
inline const Camera kWalker{96, 72, 80, 80, 47.5, 35.5, 1000};

inline Rigid3 world_from_camera(std::size_t frame) {
  Rigid3 pose;
  pose.translation.x() = static_cast<double>(frame) * kStep_px / kWalker.fx * kWall_m;
  return pose;
}

// Grey squares of 5 pixels, no two of them alike.
inline frame::RgbdFrame frame_at(std::size_t frame) {
  constexpr int kSquare_px = 5;
  frame::RgbdFrame made{0.1 * static_cast<double>(frame), DepthImage(kWalker.width, kWalker.height),
                        ColorImage(kWalker.width, kWalker.height)};
  for (int y = 0; y < kWalker.height; ++y)
    for (int x = 0; x < kWalker.width; ++x) {
      const int along_px = x + static_cast<int>(frame) * kStep_px;
      const auto square = static_cast<std::uint32_t>(along_px / kSquare_px * 64 + y / kSquare_px);
      const auto grey = static_cast<std::uint8_t>(square * 2654435761u >> 24);
      const auto at = static_cast<std::size_t>(y * kWalker.width + x);
      made.depth.pixels[at] = static_cast<std::uint16_t>(kWall_m * kWalker.depth_units_per_metre);
      made.color.pixels[at] = {grey, grey, grey};
    }
  return made;
}

// Opens a submap with every second frame, and leaves the first ones behind.
inline std::unique_ptr<adjust::Mapping> make_walker(adjust::CorrectionTime time) {
  adjust::AdjustOptions options;
  options.local_bundle_adjustment = true;
  options.submap_distance_m = 0.3;
  options.active_path_m = 0.3;
  // Planes are numbers of any value, and so many that nothing else of the state would be changed.
  options.depth_links = false;
  return adjust::make_mapping(kWalker, options, time);
}

}  // namespace hermite::fuzz
