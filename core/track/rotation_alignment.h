// The camera's rotation between consecutive frames, by aligning their grey images (the photometric
// pre-alignment of paper section 4). One thread at a time, the device's.
#pragma once

#include <Eigen/Geometry>

#include "core/base/byte_stream.h"
#include "core/frame/preprocess.h"
#include "core/gpu/commands.h"
#include "shaders/shared/track.h"

namespace hermite::track {

class RotationAlignment {
 public:
  // Keeps references to `commands`, in which nothing is recorded while align() runs, and to
  // `partial_sums`, which has room for the sums of kMaxOdometryGroups. `finest` gives the size of
  // the finest level of frames.
  RotationAlignment(gpu::Device& device, const shared::Intrinsics& finest, gpu::Commands& commands,
                    gpu::Buffer<float>& partial_sums);

  // Returns current_from_previous, from the grey images of the frame and of the last remembered
  // one; identity if there is none or if it does not match. Blocks until the GPU is done.
  Eigen::Quaterniond align(const frame::FrameMaps& frame);

  // Records keeping the frame's grey image for the next align().
  void remember(gpu::Commands& commands, const frame::FrameMaps& frame);

  // Save and restore the remembered image. Between submissions.
  void save(ByteWriter& bytes) const;
  void restore(ByteReader& bytes);

 private:
  gpu::Kernel rotation_;
  gpu::Commands& commands_;
  gpu::Buffer<float>& partial_sums_;
  const std::uint32_t pixels_per_thread_;
  gpu::Buffer<float> previous_intensity_;  // of level kRotationLevel
  shared::Intrinsics previous_camera_{};
  bool has_previous_ = false;
};

}  // namespace hermite::track
