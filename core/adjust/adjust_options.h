// Options of submaps, links and loop closure. The key and the reason of each default are in
// core/pipeline/options.cpp.
#pragma once

namespace hermite::adjust {

struct AdjustOptions {
  bool local_bundle_adjustment = false;
  // Loop closure, joining of components, relocalisation, and the adjustments that follow.
  bool global_bundle_adjustment = true;
  // After the last frame, aligns submaps by their keyframes' depth if a loop was closed.
  bool depth_links = true;
  double submap_distance_m = 0.3;
  double submap_turn_deg = 20.0;
  double keyframe_distance_m = 0.1;
  double keyframe_turn_deg = 7.0;
  double active_path_m = 2.0;
  int new_part_after_frames = 15;
};

}  // namespace hermite::adjust
