// The noise of a depth sensor, measured from its frames: its size relative to the options' model,
// and the distance over which errors of neighbouring pixels correlate. Both differ too much between
// sensors for a fixed filter: a Kinect v1's noise correlates over three pixels and more, that of a
// rendered image not at all. Runs on the host.
#pragma once

#include "core/base/byte_stream.h"
#include "core/base/image.h"
#include "core/frame/frame_mean.h"
#include "core/frame/frame_options.h"

namespace hermite::frame {

// Returns the standard deviation of a measurement in the options' model, which is that of a Kinect
// v1 (Nguyen, Izadi, Lovell 2012).
double model_deviation_m(const FrameOptions& options, double depth_m);

// Noise of one frame: standard deviations of differences between pixels two and eight apart on flat
// surfaces, in units of the options' model.
struct NoiseSample {
  bool is_known = false;  // false if there was too little surface
  double near = 0, far = 0;
};

// Measures second differences of inverse depth, which are zero on planes. The largest two fifths
// are dropped, as edges and curved surfaces. Takes below a millisecond for 640x480. Any thread.
NoiseSample measure_noise(const DepthImage& depth, double units_per_metre,
                          const FrameOptions& options);

// Accumulates the noise of all frames so far. One thread at a time.
class SensorNoise {
 public:
  void add(const NoiseSample& sample);

  // Returns the standard deviation of a measurement relative to the options' model; 1 before it is
  // known.
  double scale() const;

  // Returns 0 if the errors of pixels are independent, 1 if they correlate as in the Kinect noise
  // that sequences are disturbed with, and more if they correlate over larger distances; 0 before
  // it is known.
  double correlation() const;

  void save(ByteWriter& bytes) const { squares_.save(bytes); }
  void restore(ByteReader& bytes);

 private:
  FrameMean<2> squares_;  // near, far
};

// Widths of the bilateral filter: in the image, and in depth in standard deviations of the options'
// model.
struct FilterWidths {
  double space_px = 0, depth_deviations = 0;
};
FilterWidths filter_widths(const FrameOptions& options, const SensorNoise& noise);

}  // namespace hermite::frame
