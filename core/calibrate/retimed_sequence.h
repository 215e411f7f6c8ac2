// A recording whose frames are corrected for the time at which their rows were taken.
#pragma once

#include <memory>
#include <optional>

#include "core/calibrate/image_timing.h"
#include "core/dataset/changed_sequence.h"
#include "core/dataset/trajectory.h"
#include "core/frame/rectify.h"

namespace hermite {

// The same frames as the camera would have seen them in one instant, that of the time stamp. Each pixel is moved by the
// motion of the camera between the two times (moved_view.h), which is that of `trajectory`, the poses of an earlier
// reconstruction. Frames without a velocity there (twist_per_s_at) are as in the original. Objects are assumed not to
// move by themselves.
//
// The frames are rectified, so the camera is rectified(original->camera()). The corrected colour is a JPEG of quality
// kRetimedJpegQuality. Const functions are thread-safe.
inline constexpr int kRetimedJpegQuality = 95;

class RetimedSequence : public ChangedSequence {
 public:
  RetimedSequence(std::unique_ptr<Sequence> original, const ImageTiming& timing, Trajectory trajectory);

  const Camera& camera() const override { return camera_; }
  Result<RecordedFrame> read(std::int64_t index) const override;

 private:
  RgbdFrame retimed(const RgbdFrame& frame, const Vector6d& twist_per_s) const;
  DepthImage retimed_depth(const DepthImage& depth, const Vector6d& twist_per_s) const;

  const std::optional<Rectifier> rectifier_;
  const Camera camera_;
  const Image<Eigen::Vector3d> rays_;
  const ImageTiming timing_;
  const Trajectory trajectory_;
};

}  // namespace hermite
