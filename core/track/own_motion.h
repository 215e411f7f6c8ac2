// Detects surfaces that move on their own before they have moved far. A frame is aligned with an
// earlier view; a surface that fits significantly better with a motion other than that of the rest
// moves on its own. A person who walks ahead of the camera from the first frame hardly changes
// position in the view; only the room behind shows that they move.
//
// Pure functions on the host. Any thread.
#pragma once

#include <vector>

#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"
#include "core/track/view_surfaces.h"

namespace hermite::track {

// Motion of the camera between an earlier view and a frame. The twists, as for exp_se3, are the
// steps from the frame before each of the two.
struct CameraMotion {
  Rigid3 earlier_from_frame;  // may be some centimetres off
  Vector6d step_before_earlier = Vector6d::Zero(), step_before_frame = Vector6d::Zero();
};

enum class OwnMotion { kUnknown, kRests, kMoves };

struct OwnMotions {
  std::vector<OwnMotion> of_surface;  // by number; number 0 is unknown
  // Chi-squares of resting surfaces relative to those of independent noise, at least 1.
  double disagreement = 1;
  // Something moves that is too large to decide which of the parts is the room.
  bool is_divided = false;
  // Change of CameraMotion::earlier_from_frame, as a twist for exp_se3, if the surface were left
  // out that contradicts the others most certainly without being said to move; zero if none does. A
  // door that begins to swing pulls the camera before its motion is large.
  Vector6d pull = Vector6d::Zero();
};

// What is known of the surfaces from other frames.
struct SurfaceExperience {
  std::vector<bool> moved_before;  // by number: these do not influence the camera's motion at first
  double usual_disagreement = 1;   // of surfaces of this scan, at least 1
};

// Returns what each surface did between `earlier` and `frame`; kUnknown if too little of it is seen
// in both. The smaller part is taken to move: including what moved before, at most two fifths of
// the visible area in square metres.
OwnMotions own_motions(const frame::CoarseView& frame, const ViewSurfaces& surfaces,
                       const frame::CoarseView& earlier, const CameraMotion& motion,
                       const SurfaceExperience& experience);

}  // namespace hermite::track
