// Detects where the light on resting surfaces changes: a spot of sun that moves, a shadow, a
// screen, a highlight. Depth is right there, but the image would pull the camera along with the
// light. Between walls without texture such an edge is the strongest one in the image: a spot of
// 0.6 m moved the camera by half a metre (tests/accuracy/LAB.md).
//
// Frames are compared with views of the last two seconds, and not with the map, which follows the
// light.
//
// Runs on the host. One thread at a time.
#pragma once

#include <deque>

#include "core/base/byte_stream.h"
#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"

namespace hermite::track {

class LightChanges {
 public:
  // Returns where the light that changed in the last frame is expected in this one, before its pose
  // is known: a mask of the size of `view`, all zero if nothing changed.
  frame::CoarseMask expected(const frame::CoarseView& view) const;

  // Returns the pixels of the frame, seen from `world_from_camera`, whose brightness contradicts
  // the remembered views, by connected regions and with the pixels around them. The exposure of
  // each view is unknown. All zero if much of the surface contradicts them: then it is the image as
  // a whole, or the pose, that differs. `moving` pixels, of the same size, are ignored.
  frame::CoarseMask changed(const frame::CoarseView& view, const Rigid3& world_from_camera,
                            const frame::CoarseMask& moving) const;

  // Makes the frame, with its final pose and regions, the last frame; every eighth one is kept for
  // comparison.
  void remember(const frame::CoarseView& view, const Rigid3& world_from_camera,
                const frame::CoarseMask& moving, const frame::CoarseMask& changed);

  // Drops the remembered views, which are useless after the camera was lost or the map was
  // corrected.
  void forget();

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  struct Seen {
    frame::CoarseView view;
    Rigid3 world_from_camera;
    frame::CoarseMask moving;
  };
  enum class Light : std::uint8_t { kUnknown, kSame, kChanged };
  static std::vector<Light> light_since(const Seen& seen, const frame::CoarseView& frame,
                                        const Rigid3& world_from_camera,
                                        const frame::CoarseMask& moving);

  std::deque<Seen> seen_;  // oldest first
  frame::CoarseView last_view_;
  frame::CoarseMask last_changed_;
  std::uint32_t frames_since_kept_ = 0;
};

}  // namespace hermite::track
