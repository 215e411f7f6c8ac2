// The noise of a depth sensor, measured on the frames themselves: how much it is beside what the options say, and how far neighbouring
// pixels err alike. Both differ between sensors by more than a filter can overlook: the noise of a Kinect v1 goes together over three
// pixels and more, that of a rendered image is none.
//
// Host only, no GPU.
#pragma once

#include "core/base/byte_stream.h"
#include "core/base/image.h"
#include "core/frame/frame_options.h"

namespace hermite {

// The standard deviation of a measurement as the options' model has it, which is that of a Kinect v1 (Nguyen, Izadi, Lovell 2012).
double model_deviation_m(const FrameOptions& options, double depth_m);

// Of one frame: standard deviations of the noise in those of the options' model, as they show between pixels that are two and eight apart,
// where surfaces are flat.
struct NoiseSample {
  bool is_known = false;  // there was enough surface
  double near = 0, far = 0;
};

// Second differences of inverse depth, which are zero on planes. The larger two fifths are left out: edges, and what is not flat. Below a
// millisecond for 640x480. Any thread.
NoiseSample measure_noise(const DepthImage& depth, double units_per_metre, const FrameOptions& options);

// What the frames so far say together. One thread at a time.
class SensorNoise {
 public:
  void add(const NoiseSample& sample);

  // The standard deviation of a measurement over that of the options' model; 1 before anything is known.
  double scale() const;

  // 0 where pixels err independently of each other, 1 where they do as in the Kinect's noise that sequences are disturbed by, more where
  // they err alike over a larger distance; 0 before anything is known.
  double correlation() const;

  void save(ByteWriter& bytes) const { bytes.number(sums_); }
  void restore(ByteReader& bytes);

 private:
  struct {
    double frames = 0, near2 = 0, far2 = 0;  // sums of squares
  } sums_;
};

// Of the bilateral filter: over the image, and over depth in standard deviations of the options' model.
struct FilterWidths {
  double space_px = 0, depth_deviations = 0;
};
FilterWidths filter_widths(const FrameOptions& options, const SensorNoise& noise);

}  // namespace hermite
