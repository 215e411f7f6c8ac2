#include "core/pipeline/lost_poses.h"

namespace hermite::pipeline {

std::size_t place_lost_frames(std::vector<AnchoredPose>& poses, const adjust::MapLayout& layout) {
  if (poses.empty() || poses.back().status == track::TrackingStatus::kLost) return poses.size();
  std::size_t first = poses.size() - 1;
  while (first > 0 && poses[first - 1].status == track::TrackingStatus::kLost) --first;
  // Nothing was tracked before, or nothing was lost.
  if (first == 0 || first + 1 == poses.size()) return poses.size();
  const AnchoredPose &before = poses[first - 1], &after = poses.back();
  const double lost_s = after.timestamp_s - before.timestamp_s;
  if (layout.component[before.submap] != layout.component[after.submap] || !(lost_s > 0))
    return poses.size();
  const Rigid3 submap_from_after = inverse(layout.world_from_submap[before.submap]) *
                                   layout.world_from_submap[after.submap] *
                                   after.submap_from_camera;
  for (std::size_t i = first; i + 1 < poses.size(); ++i) {
    poses[i].submap = before.submap;
    poses[i].submap_from_camera = between(before.submap_from_camera, submap_from_after,
                                          (poses[i].timestamp_s - before.timestamp_s) / lost_s);
  }
  return first;
}

}  // namespace hermite::pipeline
