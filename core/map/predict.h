// Prediction of the map's surface for a pose, as a pyramid for odometry (paper section 3.1).
#pragma once

#include "core/frame/brightness.h"
#include "core/frame/preprocess.h"
#include "core/map/index_map.h"
#include "core/map/map_options.h"

namespace hermite::map {

// What fills the prediction where the map covers too little of the view: nothing, or the surface of
// a frame at the same pose.
enum class FillIn { kNothing, kSurface, kSurfaceAndColor };

class Predictor {
 public:
  // `camera` has the size of all frames.
  Predictor(gpu::Device& device, const shared::Intrinsics& camera, const MapOptions& options);

  // Records the prediction from an index map of stable surfels, for the camera that the store was
  // set to. Where the map covers less than options.fill_in_below of the view, the pixels of `frame`
  // fill it, at the brightness of the map.
  void run(gpu::Commands& commands, const SurfelStore& store, const IndexMap& stable,
           const frame::FrameMaps& frame, FillIn fill_in = FillIn::kSurfaceAndColor,
           const frame::Brightness& brightness = {});

  // Its weight is the tracking weight; its intensity is -1 without colour. The caller must record
  // `downsample` for levels 1 and 2.
  frame::SurfacePyramid& surface() { return surface_; }
  const frame::SurfacePyramid& surface() const { return surface_; }

 private:
  const MapOptions options_;
  gpu::Kernel describe_, predict_, fill_in_;
  gpu::Buffer<shared::uvec4> kernels_;  // per pixel, with a margin
  gpu::Buffer<shared::uint> covered_pixel_count_;
  frame::SurfacePyramid surface_;
};

}  // namespace hermite::map
