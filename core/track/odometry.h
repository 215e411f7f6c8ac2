// Frame-to-model odometry: photometric rotation first, then three levels of Gauss-Newton on curvature-weighted point-to-plane and
// photometric terms (paper section 4). Every step is one dispatch; the host adds the workgroups' sums in order and solves in double
// precision.
#pragma once

#include <span>
#include <string>

#include "core/frame/preprocess.h"
#include "core/math/rigid3.h"
#include "core/track/track_options.h"
#include "shaders/shared/track.h"

namespace hermite {

struct OdometryResult {
  Rigid3 reference_from_camera;
  bool tracked = false;
  std::string reason;             // in words when not tracked
  std::int64_t inlier_count = 0;  // geometric correspondences in the last step, at full resolution
  double inlier_ratio = 0;        // of the pixels looked at that have a surface
  double residual_rms_m = 0;      // point to plane, over the inliers
  std::int64_t photometric_count = 0;
  int iteration_count = 0;
};

class Odometry {
 public:
  // `finest` is the size of the frames' and the references' finest level.
  Odometry(gpu::Device& device, const shared::Intrinsics& finest, const TrackOptions& options);

  // The frame against the surface predicted from the reference pose, starting at the guess that fits best. Blocks until the GPU is done.
  OdometryResult track(const FrameMaps& frame, const SurfacePyramid& reference, std::span<const Rigid3> guesses);

  // current_from_previous, from the grey images of the frame and of the last one remembered; identity when there is none or it does not
  // fit.
  Eigen::Quaterniond align_rotation(const FrameMaps& frame);

  // Whether the frame shows enough surface to start a map from. `reference` may be empty.
  OdometryResult start(const FrameMaps& frame, const SurfacePyramid& reference);

  // Keeps the frame's grey image for the next align_rotation.
  void remember(gpu::Commands& commands, const FrameMaps& frame);

 private:
  struct Sums;
  Sums linearise(const FrameMaps& frame, const SurfacePyramid& reference, const Rigid3& guess, int level, bool search);
  Rigid3 best_of(std::span<const Rigid3> guesses, const FrameMaps& frame, const SurfacePyramid& reference);
  bool sees_enough(const Sums& sums, OdometryResult& result) const;
  void judge(const Sums& sums, OdometryResult& result) const;

  const TrackOptions options_;
  gpu::Kernel odometry_, rotation_;
  gpu::Commands commands_;
  gpu::Buffer<float> partial_sums_;
  gpu::Buffer<float> previous_intensity_;  // of level kRotationLevel
  shared::Intrinsics previous_camera_{};
  bool has_previous_ = false;
};

}  // namespace hermite
