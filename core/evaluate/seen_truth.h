// All of the true surface that a sequence has seen, to judge a mesh by: more frames than true_surface.h takes, where the surface has
// creases, and what cameras beside the path would see.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "core/base/image.h"
#include "core/base/result.h"
#include "core/dataset/sequence.h"

namespace hermite {

// Samples are one for each cube of this side that a frame has seen.
inline constexpr double kSampleSpacing_m = 0.005;

// What a camera that was moved from the path by up to 15 cm and 10 degrees along and about every axis would see.
struct BesideView {
  Rigid3 world_from_camera;
  Image<float> depth_m;  // 0: nothing, or nothing that a frame of the sequence has seen
};

struct SeenTruth {
  std::function<double(const Eigen::Vector3d&)> distance_m;  // of a point of the true world, at most kSurfaceReach_m (true_surface.h)
  std::vector<Eigen::Vector3d> samples;
  // Points, a centimetre apart, that have one with a normal 30 to 150 degrees away within 1.5 cm: where the surface bends sharply, not
  // where it ends or turns its back.
  std::vector<Eigen::Vector3d> creases;
  Camera view_camera;  // half the sequence's size where that is more than 320 wide
  std::vector<BesideView> views;
};

struct SeenTruthOptions {
  std::int64_t frame_stride = 5;
  int view_count = 200;
};

// From every so-many-th frame, at the poses of the ground truth. Of the synthetic rooms distances and views are exact; else they are
// those of the depth. Frames that cannot be read or have no pose are left out. kNotFound: no ground truth.
Result<SeenTruth> seen_truth(const Sequence& sequence, const std::string& source, const SeenTruthOptions& options = {});

}  // namespace hermite
