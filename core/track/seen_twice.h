// Points that two views of a scan show, by which a camera's lens and depth can be calibrated during
// the scan.
//
// Runs on the host. One thread at a time.
#pragma once

#include <optional>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"

namespace hermite::track {

struct PlaceSeenTwice {
  int now_x, now_y, earlier_x, earlier_y;  // coarse pixels
};

// The view with which frames are compared: one that shows at least two fifths of what they show.
class EarlierView {
 public:
  struct Comparison {
    const frame::CoarseView& earlier;
    Rigid3 earlier_from_now;
    std::vector<PlaceSeenTwice> places;
  };

  // Returns what a frame at that pose has in common with the earlier view, ignoring `moving`
  // pixels; std::nullopt if there is no earlier view. Valid until the next keep().
  std::optional<Comparison> compare(const frame::CoarseView& now, const Rigid3& world_from_camera,
                                    const frame::CoarseMask& moving) const;

  // Replaces the earlier view by the frame if the comparison has found too few common points.
  void keep(const frame::CoarseView& now, const Rigid3& world_from_camera,
            const frame::CoarseMask& moving, std::size_t places_found);

  void forget() { *this = {}; }

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  frame::CoarseView view_;
  Rigid3 world_from_camera_;
};

// Returns the squared distance from the principal point over that of the farthest corner, 0 to 1.
double squared_image_distance(const shared::Intrinsics& camera, double x, double y);

}  // namespace hermite::track
