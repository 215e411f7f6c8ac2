// Options of submaps, links and loop closure. The key and the reason of each default are in
// core/pipeline/options.cpp.
#pragma once

namespace hermite::adjust {

struct AdjustOptions {
  bool local_bundle_adjustment = false;
  bool global_bundle_adjustment = true;  // loop closure, joining of components, relocalisation, and the adjustments that follow
  bool depth_links = true;               // after the last frame, aligns submaps by their keyframes' depth if a loop was closed
  double submap_distance_m = 0.3;
  double submap_turn_deg = 20.0;
  double keyframe_distance_m = 0.1;
  double keyframe_turn_deg = 7.0;
  double active_path_m = 2.0;
  int new_part_after_frames = 15;
};

}  // namespace hermite::adjust
