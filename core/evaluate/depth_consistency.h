// How well the depth images of a sequence agree under a trajectory: two frames that see the same surface must see it in the same place.
// Needs no true poses, and so judges a ground truth as well as an estimate. Pure functions, on the calling thread.
//
// For a pair of frames (i, i + spacing), the points of i are moved into i + spacing by the relative pose, and their distances to the planes
// of the surface there are taken. Point and plane come from the pixels around: 1/depth is linear in the pixels of a plane, so the mean of
// the central differences of 1/depth, over a window of 9x9 at 640 pixels across, gives the normal, and the mean of 1/depth the place.
//
// What it cannot see: motion along bare walls; drift between frames that see nothing in common; and what the sensor bends alike in every
// frame, to which poses made from the same depth are fitted and true ones are not.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/sequence.h"
#include "core/dataset/trajectory.h"

namespace hermite {

// Depths outside are no measurement here: nearer a Kinect sees nothing, beyond its noise (13 mm at 3 m) hides that of the poses.
inline constexpr double kNearestConsistent_m = 0.4, kFarthestConsistent_m = 3.0;
// Of all depths of a window to its middle, as a share of that; more is an edge, and a missing depth is one too.
inline constexpr double kMaxWindowSpread = 0.03;
// Between the ray and the normal, seen by either frame.
inline constexpr double kMaxSlant_deg = 70;
// Between the normals of both frames; more is another surface.
inline constexpr double kMaxNormalAngle_deg = 37;
// In depth, between a point and the surface at its pixel; more is another surface, in front or behind.
inline constexpr double kMaxDepthGap_m = 0.10;
// Distances are cut to this, so that the few that meet another surface after all do not decide.
inline constexpr double kMaxConsistent_m = 0.05;
// A pair of frames counts when at least this share of the first one's points meets a surface in the second, and at least so many points.
inline constexpr double kMinConsistentOverlap = 0.2;
inline constexpr std::size_t kMinConsistentPoints = 50;

struct ConsistencyOptions {
  std::vector<std::int64_t> spacings{5, 20, 80, 320};  // frames, each at least 1
  std::int64_t max_first_frames = 250;                 // at least 1; spread evenly over the sequence, the same for every spacing
};

// Of one trajectory at one spacing, over all points of all pairs that count.
struct Consistency {
  double median_m = 0, rms_m = 0;  // of the distances
  double overlap = 0;              // mean share of the points that meet a surface
  double better_share = 0;  // of the pairs, in which its root mean square is less than every other trajectory's; 0 if there is no other
};

struct SpacingConsistency {
  std::int64_t spacing_frames = 0;
  std::int64_t tried_count = 0;           // pairs of readable frames that have poses in every trajectory
  std::int64_t pair_count = 0;            // those that overlap enough under every trajectory
  std::vector<Consistency> trajectories;  // in the order given; empty when no pair counts
};

// One entry a spacing. A frame's pose is `pose_at` its time (trajectory.h); frames without one are passed over.
// kInvalidArgument, in words: a spacing below 1, no spacing, no trajectory, one that validate() refuses or that has no pose for any frame.
Result<std::vector<SpacingConsistency>> depth_consistency(const Sequence& sequence, const std::vector<Trajectory>& trajectories,
                                                          const ConsistencyOptions& options = {});

// {"consistency": [one object a spacing]}, keys: spacing_frames, pairs_tried, pairs, and, where there are pairs, for each name
// <name>_median_m, <name>_rms_m, <name>_overlap, and with several names <name>_better_share. As many names as trajectories.
std::string format_consistency_json(const std::vector<SpacingConsistency>& spacings, const std::vector<std::string>& names);

}  // namespace hermite
