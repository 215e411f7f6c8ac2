// The surface that the map predicts for a pose, with a pyramid for the odometry (paper section 3.1).
#pragma once

#include "core/frame/brightness.h"
#include "core/frame/preprocess.h"
#include "core/map/index_map.h"
#include "core/map/map_options.h"

namespace hermite {

// What stands in where the map covers too little of the view: nothing, or the surface of a frame seen from the same pose.
enum class FillIn { kNothing, kSurface, kSurfaceAndColor };

class Predictor {
 public:
  // `camera` has the size of all frames.
  Predictor(gpu::Device& device, const shared::Intrinsics& camera, const MapOptions& options);

  // Records the prediction from an index map of stable surfels, for the camera the store was set to and the pixels of `frame`, which may
  // stand in where the map covers less than options.fill_in_below of the view, at the brightness of the map.
  void run(gpu::Commands& commands, const SurfelStore& store, const IndexMap& stable, const FrameMaps& frame,
           FillIn fill_in = FillIn::kSurfaceAndColor, const Brightness& brightness = {});

  // weight is the tracking weight; intensity -1 where there is no colour. `downsample` must be recorded by the caller for levels 1 and 2.
  SurfacePyramid& surface() { return surface_; }
  const SurfacePyramid& surface() const { return surface_; }

 private:
  const MapOptions options_;
  gpu::Kernel describe_, predict_, fill_in_;
  gpu::Buffer<shared::uvec4> kernels_;  // by pixel, with a margin
  gpu::Buffer<shared::uint> covered_pixel_count_;
  SurfacePyramid surface_;
};

}  // namespace hermite
