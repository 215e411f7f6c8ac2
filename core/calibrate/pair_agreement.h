// How well pairs of views agree with a trial camera at given poses. Pure functions, any thread.
#pragma once

#include <cstdint>
#include <vector>

#include "core/calibrate/joint_adjustment.h"
#include "core/calibrate/view_measurement.h"

namespace hermite::calibrate {

// Largest distance within one surface, and the value to which distances are clipped.
inline constexpr double kMostApart_m = 0.10, kMostCounted_m = 0.05;

// The distances of points to the planes of the other view, both ways. Up to kMostApart_m they count
// as the same surface, and they are clipped to kMostCounted_m, as in depth_consistency.h.
struct PairAgreement {
  double median_m = 0, rms_m = 0;
  // The same along the rays, divided by depth. A camera that shrinks everything gains nothing by
  // it, nor does one with a greater focal length, in which walls are steeper and distances from
  // them therefore shorter. With that, a lens with k1 = -0.04 was taken for 3.4 % of focal length
  // and 2.4 % of bend, whose distances are 1.2 % shorter.
  double relative_median = 0, relative_rms = 0;
  std::int64_t point_count = 0;
};
PairAgreement agreement_of(const std::vector<CalibrationView>& views,
                           const std::vector<Rigid3>& world_from_camera,
                           const std::vector<ViewPair>& pairs, const Camera& trial);
// The same for each pair separately.
std::vector<PairAgreement> agreements_of(const std::vector<CalibrationView>& views,
                                         const std::vector<Rigid3>& world_from_camera,
                                         const std::vector<ViewPair>& pairs, const Camera& trial);

// Largest distance of a corner from where it is expected, and the value to which errors are
// clipped.
inline constexpr double kMostApart_px = 12, kMostCounted_px = 3;

// The reprojection errors of corners of the first view in the second one, in pixels of an image 640
// wide. Corners are matched within kMostApart_px of where they are expected, and errors are clipped
// to kMostCounted_px.
struct CornerReprojection {
  double rms_px = 0;
  std::int64_t corner_count = 0;
};
std::vector<CornerReprojection> corner_reprojections_of(
    const std::vector<CalibrationView>& views, const std::vector<Rigid3>& world_from_camera,
    const std::vector<ViewPair>& pairs, const Camera& trial);

// By how much pairs agree better after a change: the mean over pairs of the relative decrease of
// squares. Pairs without a square before or after do not count.
struct PairGain {
  double mean = 0, standard_error = 0;  // 0 for fewer than two pairs
  std::size_t pair_count = 0;
};
PairGain gain_of(const std::vector<double>& squares_before,
                 const std::vector<double>& squares_after);

// Where a parameter of the camera shows: the timing of colour in corners, all others in surfaces.
enum class ShowsIn { kSurfaces, kCorners };
inline ShowsIn where_shows(std::size_t number) {
  return number == kColorReadout || number == kColorDelay ? ShowsIn::kCorners : ShowsIn::kSurfaces;
}

// The views' held-out pairs, as measured by a camera before any change. References to the caller's
// values.
struct HeldOutPairs {
  const std::vector<CalibrationView>& views;
  const std::vector<ViewPair>& pairs;
  const Camera& camera;
};
PairGain gain_of(const HeldOutPairs& held_out, const JointSolution& before,
                 const JointSolution& after, ShowsIn where);

// Squares of the relative distances of surfaces, and of the errors of corners; 0 where a pair has
// none.
std::vector<double> squares_of(const std::vector<PairAgreement>& agreements);
std::vector<double> squares_of(const std::vector<CornerReprojection>& agreements);

}  // namespace hermite::calibrate
