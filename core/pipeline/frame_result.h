// What comes of a frame. Plain values.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "core/math/rigid3.h"
#include "core/track/judgement.h"
#include "core/track/map_certainty.h"

namespace hermite {

// What a frame did to the map besides adding to it: at most one thing, a loop or a joining before the rest.
enum class MapEvent {
  kNone,
  kLost,        // the first frame that is
  kFoundAgain,  // where it was last, or at another place of the map
  kNewPart,     // not found: the map goes on in a part of its own
  kJoined,      // two parts are one from now on
  kLoopClosed,
  kRecalibrated,  // the camera was off: it is corrected, and the map is made anew from all frames so far
};
const char* name_of(MapEvent event);  // "", "lost", "found again", "new part", "joined", "loop closed", "recalibrated"

struct FrameResult {
  std::int64_t frame_index = 0;  // 0 for the first frame given to the pipeline
  double timestamp_s = 0;
  Rigid3 world_from_camera;   // the last good pose while lost
  std::uint32_t submap = 0;   // that the frame belongs to
  Rigid3 submap_from_camera;  // the same pose; a correction of the submaps leaves it as it is
  TrackingStatus status = TrackingStatus::kLost;
  std::string reason;             // in words, empty when tracked
  std::int64_t inlier_count = 0;  // geometric correspondences at full resolution
  double inlier_ratio = 0;        // of the frame's valid pixels
  double residual_rms_m = 0;      // point to plane
  std::int64_t surfel_count = 0;  // alive in the model
  MapEvent event = MapEvent::kNone;
  double correction_m = 0;               // the farthest that the origin of an active submap was moved in this frame
  std::int64_t last_tracked_frame = -1;  // index: this frame, or while lost the one that the pose is of; -1: none was tracked yet
  double last_tracked_timestamp_s = 0;   // of that frame
  // Of world_from_camera as it is in this result: corrections to come do not count. None while lost.
  std::optional<PoseUncertainty> uncertainty;
};

// A camera's pose as it stays when submaps move.
struct AnchoredPose {
  double timestamp_s = 0;
  std::uint32_t submap = 0;
  Rigid3 submap_from_camera;
  TrackingStatus status = TrackingStatus::kLost;  // of the frame: the pose of a lost one is the last that was known
};

}  // namespace hermite
