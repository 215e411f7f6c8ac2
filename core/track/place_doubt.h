// Whether a camera that saw nothing for a while is where it seems to be, or at another place that
// looks the same (perceptual aliasing): desks, doors and shelves come in series.
//
// In that time it may have gone as far as a person walks, or as far as its new place is from the
// last one if it was relocalised. If it is at a twin of the place where it seems to be, the map
// fits only as far as the twins are alike. So the place is doubtful until the camera has seen,
// after the gap, a stretch of known surface that is as long as the way it may have gone, or longer
// than what is made in series, or nearly all that is known; and something that the map does not
// have twice.
//
// Pure values. One thread at a time.
#pragma once

#include <Eigen/Geometry>

#include "core/base/byte_stream.h"
#include "core/math/rigid3.h"

namespace hermite::track {

// What happened between the last tracked frame and this one.
struct SightGap {
  // Time in which the camera saw nothing, in addition to what is usual between frames.
  double unseen_s = 0;
  // Distance from the last place to the one where the camera was relocalised; 0 if it was tracked.
  double jump_m = 0;
};

class PlaceDoubt {
 public:
  // Returns whether the gap casts doubt on the camera's place. Shorter ones are within the reach of
  // tracking.
  static bool is_cast_by(const SightGap& gap);

  // Counts such a gap. `known_m`: extent of the surface known before it.
  void count_gap(const SightGap& gap, double known_m);

  // Returns how far from its last place the camera can be found again [m], beyond the uncertainty
  // of both places: nobody scans faster than this.
  static double reach_m(double unseen_s);

  // Counts a frame after the gap. `known`: bounds [m], in the world, of the surface in it that was
  // known before the gap. `is_distinctive`: whether its image shows what is known to be here, and
  // does not recur elsewhere in the map.
  void observe(const Eigen::AlignedBox3d& known, bool is_distinctive);

  // How far the camera may be from where it seems to be [m]; 0 if there is no doubt.
  double elsewhere_m() const { return elsewhere_m_; }

  // Returns the second moment of the error (see PoseUncertainty) from this doubt alone: a twin that
  // far away and turned around lies on the boundary of the stated 99 % region.
  Matrix6d second_moment() const;

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  double elsewhere_m_ = 0;
  double needed_m_ = 0;       // extent of known surface that settles the doubt
  Eigen::AlignedBox3d seen_;  // of known surface since the gap
};

}  // namespace hermite::track
