// What moves is not the room. A frame is compared with views of the last second: where it shows a surface in what was free space then, or
// sees through a surface that was there, something has moved. Connected regions of such pixels are kept out of tracking and out of the map
// until they have rested for that second.
//
// Host only, no GPU. One thread at a time.
#pragma once

#include <deque>

#include "core/base/byte_stream.h"
#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"

namespace hermite {

class MovingRegions {
 public:
  // Where the regions of the last frame should be in this one, before its pose is known: a mask of as many pixels as `view` has, all zero
  // when nothing moved.
  CoarseMask expected(const CoarseView& view) const;

  // Where the frame contradicts the remembered views, seen from `world_from_camera`, unless most of it does: then it is rather the pose
  // that is wrong. And what has moved on its own (own_motion.h), or is `by_corners`, of the same size or empty.
  CoarseMask contradicted(const CoarseView& view, const Rigid3& world_from_camera, const CoarseMask& by_corners = {});

  // Of the frame asked about last: parts of it that are too large to know which is the room move against each other.
  bool is_divided() const { return is_divided_; }

  // The frame's pose and regions are final: it becomes the last frame, and some frames are kept to compare with.
  void remember(const CoarseView& view, const Rigid3& world_from_camera, const CoarseMask& moving);

  // The remembered views are of no use any more: the camera was lost, or the map has been corrected.
  void forget();

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  struct Seen {
    CoarseView view;
    Rigid3 world_from_camera;
    Vector6d step_before = Vector6d::Zero();  // twist from the frame before it
    CoarseMask moving;
  };
  // Of surfaces that rest, see OwnMotions.
  struct Disagreement {
    double last = 1, usual = 1;
  };
  CoarseMask moving_on_their_own(const CoarseView& view, const Rigid3& world_from_camera, const CoarseMask& by_corners);

  std::deque<Seen> seen_;  // oldest first
  CoarseView last_view_;
  Rigid3 last_world_from_camera_;
  CoarseMask last_moving_;
  Disagreement lately_, all_along_;  // with a view some frames ago, with the oldest
  std::uint32_t frames_since_kept_ = 0;
  bool is_divided_ = false;
};

}  // namespace hermite
