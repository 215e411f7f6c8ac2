// Corrects frames for the time at which their pixels were taken (Camera::timing), given the
// camera's velocity.
//
// The disturbances (core/disturb/moved_view.h) move pixels likewise, in double precision and until
// they settle. They stay apart from this, so that a correction is not tested against itself.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/frame/rgbd_frame.h"
#include "core/gpu/buffer.h"
#include "core/gpu/commands.h"
#include "core/gpu/kernel.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "shaders/shared/frame.h"

namespace hermite::frame {

// Owns the buffers of one frame. One thread at a time, the device's.
class Retimer {
 public:
  // Frames are of rectified(camera), except for the timing. The rows of a rectified image are taken
  // to be those of the received one, from which they differ by some pixels of several hundred.
  Retimer(gpu::Device& device, const Camera& camera);

  // Returns the frame as the camera would have seen it in one instant, that of the time stamp, when
  // it moves with this twist per second in its own coordinate frame (translation part first).
  // Objects are assumed not to move by themselves. What the frame does not show, beyond its border
  // and behind edges, has no depth, and colour repeats the border; pixels without depth are taken
  // to be infinitely far. The frame has the camera's size. Blocks until the GPU is done.
  RgbdFrame apply(const RgbdFrame& frame, const Vector6d& twist_per_s);

 private:
  bool moves_depth() const { return camera_.timing.depth_readout_s != 0; }
  bool moves_color() const {
    return camera_.timing.color_readout_s != 0 || camera_.timing.color_delay_s != 0;
  }
  void record_depth(const Vector6d& twist_per_s);
  void record_color(const ColorImage& taken, const Vector6d& twist_per_s);

  const Camera camera_;
  const shared::RetimeParams params_;
  gpu::Kernel retime_depth_, retime_color_;
  gpu::Commands commands_;
  std::vector<shared::uint> staged_;                  // a word per pixel
  gpu::Buffer<shared::uint> units_, units_at_stamp_;  // two pixels per word
  gpu::Buffer<shared::uint> color_, color_at_stamp_;  // r | g << 8 | b << 16
  // The camera when a row is taken, from the time stamp.
  gpu::Buffer<shared::Transform> depth_rows_, color_rows_;
};

// Returns how far apart a Retimer puts the surface with one twist and with the other, as the root
// mean square over the image, depth or colour, that is farther in time; 0 without depth. Pure.
double retiming_difference_m(const Camera& camera, const DepthImage& depth, const Vector6d& a_per_s,
                             const Vector6d& b_per_s);

// Returns the pixel of a point at the time stamp, which a rectified colour image shows at
// `pixel_px`; `point_m` is its approximate position at the time stamp, in front of the camera.
// Pure.
Eigen::Vector2d color_pixel_at_stamp(const Camera& camera, const Eigen::Vector2d& pixel_px,
                                     const Eigen::Vector3d& point_m, const Vector6d& twist_per_s);

}  // namespace hermite::frame
