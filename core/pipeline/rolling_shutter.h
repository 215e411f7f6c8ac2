// Corrects the frames of a scan for the time at which their rows were taken (Camera::timing), with
// the camera's velocity as far as it is known before the frame is tracked.
//
// The velocity is the mean since the last frame, from corners followed between the two images;
// without corners, that of the step before. Tracking finds it more accurately: where that matters,
// the frame is corrected and tracked once more. Two frames as they were taken are tracked against
// each other in the beginning: both have nearly the same shear. One thread at a time, the device's.
#pragma once

#include <optional>

#include "core/base/byte_stream.h"
#include "core/dataset/camera_velocity.h"
#include "core/frame/frame_options.h"
#include "core/frame/prepared_frame.h"
#include "core/frame/retime.h"
#include "core/math/camera.h"
#include "core/track/feature_motion.h"

namespace hermite::pipeline {

class RollingShutter {
 public:
  RollingShutter(gpu::Device& device, const Camera& camera, const frame::FrameOptions& options)
      : camera_(camera), options_(options) {
    if (camera.timing != ImageTiming{}) retimer_.emplace(device, camera);
  }

  // Returns whether there is anything to correct: the camera does not take all pixels at the time
  // stamp.
  bool is_rolling() const { return retimer_.has_value(); }

  // A frame as seen in one instant, and its pose relative to the frame of the last step() by the
  // velocity that was used.
  struct Corrected {
    frame::PreparedFrame frame;
    Rigid3 last_from_camera;
  };

  // Returns nullopt if the camera's velocity is unknown, as after a gap of more than
  // kMaxVelocityGap_s. `since_last` is the motion since the frame of the last step(), from corners
  // where this frame shows them; nullopt if unknown.
  std::optional<Corrected> corrected(const frame::PreparedFrame& frame,
                                     const std::optional<track::FeatureMotion>& since_last);

  // Returns the frame corrected by the motion since the last step() that tracking has found;
  // nullopt if that hardly differs from how it was corrected before.
  std::optional<Corrected> corrected_again(const frame::PreparedFrame& frame,
                                           const Corrected& before, const Rigid3& last_from_camera);

  // Call it for each tracked frame, with its pose relative to the frame of the last call, nullopt
  // if that is unknown, and whether the frame was corrected.
  void step(double timestamp_s, const std::optional<Rigid3>& last_from_camera, bool is_corrected);

  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  Corrected at_stamp(const frame::PreparedFrame& frame, const Rigid3& last_from_camera);
  std::optional<Vector6d> twist_per_s_at(
      double timestamp_s, const std::optional<track::FeatureMotion>& since_last) const;
  Vector6d mean_twist_per_s(const track::FeatureMotion& since_last, double duration_s) const;

  const Camera camera_;
  const frame::FrameOptions options_;
  std::optional<frame::Retimer> retimer_;
  double last_timestamp_s_ = 0;
  bool last_is_corrected_ = false;
  std::optional<Vector6d> last_twist_per_s_;  // mean of the step to that frame; nullopt: unknown
};

}  // namespace hermite::pipeline
