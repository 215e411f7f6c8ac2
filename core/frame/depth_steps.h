// The steps in which a depth sensor measures. A Kinect rounds disparity to an eighth of a pixel: 26
// mm at 3 m. Its noise is about half of that, so neighbours fall onto different steps and their
// mean has none of it. With coarser steps or less noise, surfaces are terraces that move with the
// camera, and tell it that it stands still. Runs on the host.
#pragma once

#include "core/base/byte_stream.h"
#include "core/base/image.h"
#include "core/frame/frame_mean.h"

namespace hermite::frame {

// Steps at the median depth of a frame. All zero if there is too little surface to tell.
struct DepthSteps {
  double depth_m = 0;
  double step_m = 0;
  // What the mean over many pixels keeps of the steps, as a standard deviation: none of them where
  // noise reaches over a step, all where there is no noise.
  double terrace_m = 0;
};

// Takes some tenths of a millisecond for 640x480. Any thread.
DepthSteps measure_steps(const DepthImage& depth, double units_per_metre);

// The mean over the frames so far. One thread at a time.
class SeenSteps {
 public:
  void add(const DepthSteps& frame);
  DepthSteps mean() const;

  void save(ByteWriter& bytes) const { of_frames_.save(bytes); }
  void restore(ByteReader& bytes);

 private:
  FrameMean<3> of_frames_;  // in the order of DepthSteps
};

}  // namespace hermite::frame
