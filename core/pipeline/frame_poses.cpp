#include "core/pipeline/frame_poses.h"

#include <algorithm>

#include "core/pipeline/lost_poses.h"

namespace hermite::pipeline {

void FramePoses::add(const FrameResult& result, std::uint16_t reason,
                     const Rigid3& world_from_camera, const adjust::MapLayout& layout) {
  anchored_.push_back({result.timestamp_s, layout.current,
                       inverse(layout.world_from_submap[layout.current]) * world_from_camera,
                       result.status, reason});
  trajectory_.push_back({result.timestamp_s, world_from_camera});
  follow_corrections(layout, place_lost_frames(anchored_, layout));
}

// Computes the poses in the world from `first` on, or all of them after a correction.
void FramePoses::follow_corrections(const adjust::MapLayout& layout, std::size_t first) {
  if (correction_count_ != layout.correction_count) first = 0;
  correction_count_ = layout.correction_count;
  for (std::size_t i = first; i < anchored_.size(); ++i)
    trajectory_[i].world_from_camera =
        layout.world_from_submap[anchored_[i].submap] * anchored_[i].submap_from_camera;
}

void FramePoses::describe_last(int lost_count, FrameResult& result) const {
  result.world_from_camera = trajectory_.back().world_from_camera;
  result.submap = anchored_.back().submap;
  result.submap_from_camera = anchored_.back().submap_from_camera;
  result.last_tracked_frame = result.frame_index - lost_count;
  if (result.last_tracked_frame >= 0)
    result.last_tracked_timestamp_s =
        anchored_[static_cast<std::size_t>(result.last_tracked_frame)].timestamp_s;
}

void FramePoses::require_valid(ByteReader& bytes, std::size_t submap_count,
                               std::size_t reason_count) const {
  bytes.require(std::ranges::all_of(anchored_,
                                    [](const AnchoredPose& pose) {
                                      return pose.status >= track::TrackingStatus::kTracked &&
                                             pose.status <= track::TrackingStatus::kLost;
                                    }),
                "the tracking status of a frame is unknown");
  bytes.require(
      std::ranges::all_of(anchored_,
                          [&](const AnchoredPose& pose) { return pose.reason <= reason_count; }),
      "the reason of a frame is missing");
  bytes.require(
      std::ranges::all_of(anchored_,
                          [&](const AnchoredPose& pose) { return pose.submap < submap_count; }),
      "the number of submaps is inconsistent");
}

}  // namespace hermite::pipeline
