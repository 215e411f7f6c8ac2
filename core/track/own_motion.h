// Surfaces that move on their own, told before they have gone far. A frame is aligned with an earlier view; a surface that fits
// significantly better where the others do not take it has a motion of its own. Somebody who walks ahead of the camera from the first frame
// on hardly changes his place in the view, and only the room behind him says that he moves.
//
// Pure functions, host only, any thread.
#pragma once

#include <vector>

#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"
#include "core/track/view_surfaces.h"

namespace hermite {

// Of the camera between an earlier view and a frame. Twists as exp_se3 takes them: the steps from the frame just before each of the two.
struct CameraMotion {
  Rigid3 earlier_from_frame;  // up to some centimetres wrong
  Vector6d step_before_earlier = Vector6d::Zero(), step_before_frame = Vector6d::Zero();
};

enum class OwnMotion { kUnknown, kRests, kMoves };

struct OwnMotions {
  std::vector<OwnMotion> of_surface;  // by number; number 0 is unknown
  double disagreement = 1;            // of what rests: its chi-squares over those of independent noise, at least 1
  bool is_divided = false;            // something moves against the rest that is too large to know which of both is the room
};

// What each surface has done between `earlier` and `frame`; kUnknown: too little of it is seen in both. `moved_before` (by number) do not
// take the camera along to begin with; surfaces of this scan usually disagree by `usual_disagreement`, at least 1. What is
// found to move is the smaller part: with what moved before at most two fifths of what is seen, in square metres.
OwnMotions own_motions(const CoarseView& frame, const ViewSurfaces& surfaces, const CoarseView& earlier, const CameraMotion& motion,
                       const std::vector<bool>& moved_before, double usual_disagreement);

}  // namespace hermite
