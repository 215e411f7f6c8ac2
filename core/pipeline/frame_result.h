// The result of processing a frame. Plain values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/math/rigid3.h"
#include "core/track/judgement.h"
#include "core/track/pose_uncertainty.h"

namespace hermite::pipeline {

// What a frame did to the map besides extending it. A frame has at most one event; a closed loop or
// a join takes precedence.
enum class MapEvent {
  kNone,
  kLost,        // the first lost frame
  kFoundAgain,  // relocalised, at the last pose or elsewhere in the map
  kNewPart,     // not relocalised: the map continues in a new component
  kJoined,      // two components were joined
  kLoopClosed,
  // The calibration was off and is corrected; the map was rebuilt from all frames so far.
  kRecalibrated,
};
// "", "lost", "found again", "new part", "joined", "loop closed", "recalibrated".
const char* name_of(MapEvent event);

struct FrameResult {
  std::int64_t frame_index = 0;  // 0 for the first frame given to the pipeline
  double timestamp_s = 0;
  Rigid3 world_from_camera;   // the last good pose while lost
  std::uint32_t submap = 0;   // the submap of the frame
  Rigid3 submap_from_camera;  // the same pose; corrections of submaps do not change it
  track::TrackingStatus status = track::TrackingStatus::kLost;
  std::string reason;             // as text; empty when tracked
  std::int64_t inlier_count = 0;  // geometric correspondences at full resolution
  double inlier_ratio = 0;        // share of the frame's valid pixels
  double residual_rms_m = 0;      // point to plane
  std::int64_t surfel_count = 0;  // surfels in the map
  MapEvent event = MapEvent::kNone;
  // How far this frame's correction moved the origin of an active submap, at most.
  double correction_m = 0;
  // Index of this frame, or while lost of the frame of the pose; -1: none was tracked yet.
  std::int64_t last_tracked_frame = -1;
  double last_tracked_timestamp_s = 0;  // of that frame
  // Uncertainty of world_from_camera as in this result; later corrections are not included. nullopt
  // while lost.
  std::optional<track::PoseUncertainty> uncertainty;
};

// A camera's pose relative to a submap, which does not change when submaps move.
struct AnchoredPose {
  double timestamp_s = 0;
  std::uint32_t submap = 0;
  Rigid3 submap_from_camera;
  // Status of the frame; for the pose of a lost one see lost_poses.h.
  track::TrackingStatus status = track::TrackingStatus::kLost;
  std::uint16_t reason = 0;  // in Pipeline::reasons(); 0: none
};

}  // namespace hermite::pipeline
