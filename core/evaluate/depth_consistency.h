// How well the depth images of a sequence agree under a trajectory: two frames that see the same
// surface must see it in the same place. Needs no true poses, so it can judge a ground truth as
// well as an estimate. Pure functions on the calling thread.
//
// For a pair of frames (i, i + spacing), the points of i are transformed into i + spacing by the
// relative pose, and their distances from the planes of the surface there are computed. Point and
// plane come from a window of pixels: 1/depth is linear in the pixels of a plane, so the mean of
// the central differences of 1/depth over a window (9x9 for images 640 pixels wide) gives the
// normal, and the mean of 1/depth the position.
//
// It cannot detect motion along bare walls, drift between frames that see nothing in common, or
// distortions that the sensor has in every frame, which poses estimated from the same depth fit and
// true ones do not.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/sequence.h"
#include "core/dataset/trajectory.h"

namespace hermite::evaluate {

// Depths outside this range are ignored: nearer ones a Kinect cannot measure, and farther ones have
// more noise (13 mm at 3 m) than the poses.
inline constexpr double kNearestConsistent_m = 0.4, kFarthestConsistent_m = 3.0;
// Largest difference between the depths of a window and that of its middle, as a share of the
// latter. Larger differences, and missing depths, are treated as edges.
inline constexpr double kMaxWindowSpread = 0.03;
// Between the ray and the normal, in both frames.
inline constexpr double kMaxSlant_deg = 70;
// Between the normals of both frames; beyond this it is another surface.
inline constexpr double kMaxNormalAngle_deg = 37;
// Gap in depth between a point and the surface at its pixel; beyond this it is another surface, in
// front or behind.
inline constexpr double kMaxDepthGap_m = 0.10;
// Distances are capped at this, so that the few points that meet another surface nevertheless do
// not dominate.
inline constexpr double kMaxConsistent_m = 0.05;
// A pair of frames counts if at least this share of the first one's points meets a surface in the
// second, and at least this many points do.
inline constexpr double kMinConsistentOverlap = 0.2;
inline constexpr std::size_t kMinConsistentPoints = 50;

struct ConsistencyOptions {
  std::vector<std::int64_t> spacings{5, 20, 80, 320};  // frames, each at least 1
  // At least 1; spread evenly over the sequence, the same for every spacing.
  std::int64_t max_first_frames = 250;
};

// Result of one trajectory at one spacing, over all points of all pairs that count.
struct Consistency {
  double median_m = 0, rms_m = 0;  // of the distances
  double overlap = 0;              // mean share of the points that meet a surface
  // Share of the pairs in which it has the least root mean square of all trajectories; 0 if there
  // is no other.
  double better_share = 0;
};

struct SpacingConsistency {
  std::int64_t spacing_frames = 0;
  std::int64_t tried_count = 0;           // pairs of readable frames with poses in every trajectory
  std::int64_t pair_count = 0;            // those that overlap enough under every trajectory
  std::vector<Consistency> trajectories;  // in the order given; empty when no pair counts
};

// Returns one entry per spacing. A frame's pose is `pose_at` its time (trajectory.h); frames
// without one are skipped. kInvalidArgument for a spacing below 1, no spacing, no trajectory, and a
// trajectory that validate() rejects or that has no pose for any frame.
Result<std::vector<SpacingConsistency>> depth_consistency(
    const dataset::Sequence& sequence, const std::vector<dataset::Trajectory>& trajectories,
    const ConsistencyOptions& options = {});

// Returns {"consistency": [one object per spacing]} with the keys spacing_frames, pairs_tried,
// pairs, and, if there are pairs, for each name <name>_median_m, <name>_rms_m, <name>_overlap, and
// with several names <name>_better_share. There are as many names as trajectories.
std::string format_consistency_json(const std::vector<SpacingConsistency>& spacings,
                                    const std::vector<std::string>& names);

}  // namespace hermite::evaluate
