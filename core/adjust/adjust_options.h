// How submaps are opened, linked, and corrected. Values; each has its key and reason in core/pipeline/options.cpp.
#pragma once

namespace hermite {

struct AdjustOptions {
  bool local_bundle_adjustment = false;
  bool global_bundle_adjustment = true;  // loops, joining, finding a lost camera; and what they correct
  bool depth_links = true;               // at the end, submaps are also laid by the depth of their keyframes, if a loop was closed
  double submap_distance_m = 0.3;
  double submap_turn_deg = 20.0;
  double keyframe_distance_m = 0.1;
  double keyframe_turn_deg = 7.0;
  double active_path_m = 2.0;
  int new_part_after_frames = 15;
};

}  // namespace hermite
