// The complete true surface that a sequence has seen, to judge a mesh by: from more frames than for
// true_surface.h, with the creases of the surface, and with views from cameras beside the path.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/dataset/sequence.h"

namespace hermite::evaluate {

// There is one sample for each cube of this side that a frame has seen.
inline constexpr double kSampleSpacing_m = 0.005;

// The view of a camera that was displaced from the path by up to 15 cm and rotated by up to 10
// degrees along and about each axis.
struct BesideView {
  Rigid3 world_from_camera;
  Image<float> depth_m;  // 0: no surface, or one that no frame of the sequence has seen
};

struct SeenTruth {
  // Distance of a point of the true world, at most kSurfaceReach_m (true_surface.h).
  std::function<double(const Eigen::Vector3d&)> distance_m;
  std::vector<Eigen::Vector3d> samples;
  // Points, a centimetre apart, that have a neighbour within 1.5 cm whose normal differs by 30 to
  // 150 degrees: where the surface bends sharply, not where it ends or faces away.
  std::vector<Eigen::Vector3d> creases;
  Camera view_camera;  // half the sequence's size if that is more than 320 wide
  std::vector<BesideView> views;
};

struct SeenTruthOptions {
  std::int64_t frame_stride = 5;
  int view_count = 200;
};

// Uses every frame_stride-th frame, at the poses of the ground truth. In the synthetic rooms
// distances and views are exact; otherwise they come from the depth. Frames that cannot be read or
// have no pose are skipped. kNotFound without ground truth.
Result<SeenTruth> seen_truth(const dataset::Sequence& sequence, const std::string& source,
                             const SeenTruthOptions& options = {});

}  // namespace hermite::evaluate
