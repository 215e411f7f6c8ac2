// Places that two views of a scan show: what a camera's lens and depth can be calibrated by while it scans.
//
// Host only, no GPU. One thread at a time.
#pragma once

#include <optional>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/frame/coarse_view.h"
#include "core/math/rigid3.h"

namespace hermite {

struct PlaceSeenTwice {
  int now_x, now_y, earlier_x, earlier_y;  // coarse pixels
};

// The view that frames are compared with: one that still shows two fifths of what they show.
class EarlierView {
 public:
  struct Comparison {
    const CoarseView& earlier;
    Rigid3 earlier_from_now;
    std::vector<PlaceSeenTwice> places;
  };

  // What a frame at that pose shows that the earlier view shows too; pixels of `moving` do not count. Nothing when there is no view. Valid
  // until the next keep().
  std::optional<Comparison> compare(const CoarseView& now, const Rigid3& world_from_camera, const CoarseMask& moving) const;

  // The frame takes the earlier view's place if the comparison with it has found too little.
  void keep(const CoarseView& now, const Rigid3& world_from_camera, const CoarseMask& moving, std::size_t places_found);

  void forget() { *this = {}; }

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  CoarseView view_;
  Rigid3 world_from_camera_;
};

// Squared distance from the principal point over that of the farthest corner, 0 to 1.
double squared_image_distance(const shared::Intrinsics& camera, double x, double y);

}  // namespace hermite
