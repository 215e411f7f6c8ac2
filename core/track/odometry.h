// Frame-to-model odometry: photometric rotation first, then three levels of Gauss-Newton on
// weighted point-to-plane and photometric terms (paper section 4). Every step is one dispatch; the
// host adds the workgroups' sums in order and solves in double precision.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "core/base/byte_stream.h"
#include "core/frame/preprocess.h"
#include "core/math/rigid3.h"
#include "core/track/feature_motion.h"
#include "core/track/judgement.h"
#include "core/track/odometry_step.h"
#include "core/track/odometry_sums.h"
#include "core/track/rotation_alignment.h"
#include "core/track/step_certainty.h"
#include "core/track/track_options.h"
#include "shaders/shared/track.h"

namespace hermite::track {

struct OdometryResult {
  Rigid3 reference_from_camera;
  std::int64_t inlier_count = 0;  // geometric correspondences in the last step, at full resolution
  double inlier_ratio = 0;        // share of the examined pixels that have a surface
  double residual_rms_m = 0;      // point to plane, over the inliers
  std::int64_t photometric_count = 0;
  double gradient_share = 0;  // see core/track/odometry_sums.h
  int iteration_count = 0;
  double observability = 0;      // see core/track/normal_equations.h
  frame::Brightness brightness;  // of the frame's image relative to the map's
  // Robust spread of the residuals, in standard deviations of the sensor and in grey values.
  double geometric_scale = 0, photometric_scale = 0;
  Agreement agreement;
  StepWitnesses witnesses;
  bool is_ambiguous = false;  // of search(): another pose fits nearly as well
};

class Odometry {
 public:
  // `finest` gives the size of the finest level of frames and references; of `noise`, only the
  // sensor's standard deviation is used.
  Odometry(gpu::Device& device, const shared::Intrinsics& finest, const TrackOptions& options,
           const frame::FrameOptions& noise = {});

  // Aligns the frame with the surface predicted from the reference pose, starting at the guess that
  // fits best. Corners with depth that were followed from there constrain a frame that has little
  // depth. Blocks until the GPU is done.
  OdometryResult track(const frame::FrameMaps& frame, const frame::SurfacePyramid& reference,
                       std::span<const Rigid3> guesses, const FeatureMotion* features = nullptr);

  // The same for a camera that may be far from all guesses: starts with wider gates and returns the
  // best of several results, by how much of the frame agrees in depth and how well its image fits
  // there.
  OdometryResult search(const frame::FrameMaps& frame, const frame::SurfacePyramid& reference,
                        std::span<const Rigid3> guesses);

  // Returns current_from_previous, from the grey images of the frame and of the last remembered
  // one; identity if there is none or if it does not match.
  Eigen::Quaterniond align_rotation(const frame::FrameMaps& frame) {
    return rotation_.align(frame);
  }

  // Returns how the frame's surface fits that of the reference at a pose. Either may be empty.
  Agreement agreement(const frame::FrameMaps& frame, const frame::SurfacePyramid& reference,
                      const Rigid3& reference_from_camera);

  // Records keeping the frame's grey image for the next align_rotation().
  void remember(gpu::Commands& commands, const frame::FrameMaps& frame) {
    rotation_.remember(commands, frame);
  }

  // Save and restore the remembered image, which is the only state between frames. Between
  // submissions.
  void save(ByteWriter& bytes) const { rotation_.save(bytes); }
  void restore(ByteReader& bytes) { rotation_.restore(bytes); }

 private:
  struct Gates;
  struct Terms;
  struct Start;
  Gates gates_within(double reach) const;
  static void describe(OdometryResult& result, const OdometrySums& sums,
                       const ExpectedResiduals& expected);
  std::vector<OdometrySums> linearise(const frame::FrameMaps& frame,
                                      const frame::SurfacePyramid& reference,
                                      std::span<const Rigid3> guesses, const Terms& terms);
  std::vector<Start> by_misfit(std::span<const Rigid3> guesses, const frame::FrameMaps& frame,
                               const frame::SurfacePyramid& reference, double reach);
  OdometryResult refine(const frame::FrameMaps& frame, const frame::SurfacePyramid& reference,
                        const Start& start, double reach, const FeatureMotion* features = nullptr);

  const TrackOptions options_;
  const frame::FrameOptions noise_;
  const std::uint32_t pixels_per_thread_;
  gpu::Kernel odometry_, agreement_;
  // The odometry with a search for the least dissimilar point, where that is an option.
  std::optional<gpu::Kernel> searching_;
  gpu::Commands commands_;
  gpu::Buffer<shared::ResidualModel> residual_model_;
  gpu::Buffer<float> partial_sums_;
  RotationAlignment rotation_;
};

}  // namespace hermite::track
