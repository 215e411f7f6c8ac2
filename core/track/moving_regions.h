// Detects moving regions. A frame is compared with views of the last second: where it shows a
// surface in what was free space, or sees through a surface that was there, something has moved.
// Connected regions of such pixels are excluded from tracking and from the map until they have
// rested for that second.
//
// Runs on the host. One thread at a time.
#pragma once

#include <algorithm>
#include <deque>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"
#include "core/track/own_motion.h"

namespace hermite::track {

class MovingRegions {
 public:
  // Returns where the moving regions of the last frame are expected in this one, before its pose is
  // known: a mask of the size of `view`, all zero if nothing moved.
  frame::CoarseMask expected(const frame::CoarseView& view) const;

  // Returns where the frame, seen from `world_from_camera`, contradicts the remembered views,
  // unless most of it does, which rather means that the pose is wrong. Includes surfaces that have
  // moved on their own (own_motion.h) and `by_corners`, which has the same size or is empty.
  // `surfaces`: those of the view.
  frame::CoarseMask contradicted(const frame::CoarseView& view, const ViewSurfaces& surfaces,
                                 const Rigid3& world_from_camera,
                                 const frame::CoarseMask& by_corners = {});

  // Returns whether parts of the frame last passed to contradicted() move relative to each other
  // and are too large to decide which of them is the room.
  bool is_divided() const { return is_divided_; }

  // Returns by how much chi-squares of resting surfaces exceed those of independent noise lately,
  // at least 1 (OwnMotions::disagreement).
  double disagreement() const { return std::max(lately_.usual, all_along_.usual); }

  // Returns by how much the pose of the frame last passed to contradicted() would change, as a
  // twist about the world's origin, without the surface that contradicts the others most; zero if
  // none does (OwnMotions::pull).
  const Vector6d& pull_world() const { return pull_world_; }

  // Makes the frame, with its final pose and regions, the last frame; every fourth one is kept for
  // comparison.
  void remember(const frame::CoarseView& view, const Rigid3& world_from_camera,
                const frame::CoarseMask& moving);

  // Drops the remembered views, which are useless after the camera was lost or the map was
  // corrected.
  void forget();

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  struct Seen {
    frame::CoarseView view;
    std::vector<Eigen::Vector3d> points;  // of the view
    Rigid3 world_from_camera;
    Vector6d step_before = Vector6d::Zero();  // twist from the frame before it
    frame::CoarseMask moving;
  };
  // How much resting surfaces disagree, see OwnMotions.
  struct Disagreement {
    double last = 1, usual = 1;
  };
  std::vector<bool> moving_before(const frame::CoarseView& view, const ViewSurfaces& surfaces,
                                  const frame::CoarseMask& by_corners) const;
  const Seen& recent() const;
  void add_own_motions(const ViewSurfaces& surfaces, const std::vector<bool>& moved_before,
                       const OwnMotions& lately, const OwnMotions& all_along,
                       frame::CoarseMask& moving);

  std::deque<Seen> seen_;  // oldest first
  frame::CoarseView last_view_;
  Rigid3 last_world_from_camera_;
  frame::CoarseMask last_moving_;
  // Compared with a view some frames ago, and with the oldest one.
  Disagreement lately_, all_along_;
  std::uint32_t frames_since_kept_ = 0;
  bool is_divided_ = false;
  Vector6d pull_world_ = Vector6d::Zero();
};

}  // namespace hermite::track
