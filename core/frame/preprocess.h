// Computes frame maps from a sensor frame: filtered depth, the HRBF surface with normals,
// curvatures and confidence, and grey images (paper section 3.2 to 3.4).
#pragma once

#include <array>

#include "core/frame/coarse_view.h"
#include "core/frame/frame_options.h"
#include "core/frame/rgbd_frame.h"
#include "core/frame/sensor_noise.h"
#include "core/frame/surface_pyramid.h"

namespace hermite::frame {

// All maps have the sampled pixels only.
struct FrameMaps {
  gpu::Buffer<float> raw_depth_m;       // as measured, within the range
  gpu::Buffer<float> filtered_depth_m;  // after the bilateral filter
  // Kernels of the HRBF, with a margin: depth, and normal from central differences.
  gpu::Buffer<shared::uvec4> kernels;
  gpu::Buffer<shared::uint> color;  // r | g << 8 | b << 16
  SurfacePyramid surface;           // weight is the confidence c = c_r c_d
  std::array<gpu::Buffer<shared::GreyAndGradient>, kPyramidLevels> images;

  const shared::Intrinsics& camera() const { return surface.levels[0].camera; }
};

// Owns the maps of the current frame. One thread at a time, the device's.
class Preprocessor {
 public:
  Preprocessor(gpu::Device& device, const Camera& camera, const FrameOptions& options);

  // Sets the lens shading by which the following frames' colours are divided, per pixel of the
  // whole image; empty: no division.
  void set_shading(std::vector<float> darkening) { darkening_ = std::move(darkening); }

  // Sets the filter for the following frames.
  void set_filter(const FilterWidths& widths) { filter_ = widths; }

  // Uploads the frame (whose size the caller has checked) and records the passes; the maps are
  // valid once `commands` has run. `frame_index` determines the sampled pixels.
  const FrameMaps& run(gpu::Commands& commands, const RgbdFrame& frame, std::int64_t frame_index);

  // Records the masking of pixels of the last preprocessed frame at all levels; odometry and fusion
  // ignore them. Uploads the mask, which has the size of the coarsest level.
  void mask(gpu::Commands& commands, const CoarseMask& mask);

  // The same for their brightness alone; odometry ignores it.
  void mask_image(gpu::Commands& commands, const CoarseMask& mask);

  const FrameMaps& maps() const { return maps_; }
  const gpu::Kernel& downsample_kernel() const { return downsample_; }

 private:
  void upload(const RgbdFrame& frame);
  shared::MaskParams mask_params(std::size_t level) const;

  const Camera camera_;
  const FrameOptions options_;
  const int step_;
  FilterWidths filter_;
  gpu::Kernel inverse_depth_, bilateral_, normals_, surface_, intensity_, gradient_, downsample_,
      mask_, mask_image_;
  std::vector<float> darkening_;
  // Buffers of the whole image with a margin; their elements are eight and four pixels:
  std::vector<std::uint16_t> staged_units_;
  gpu::Buffer<shared::uvec4> units_;
  gpu::Buffer<shared::vec4> inverse_depth_per_m_;
  // Buffers without a margin:
  std::vector<shared::uint> staged_color_;
  gpu::Buffer<shared::uint> color_;
  gpu::Buffer<shared::uint> mask_pixels_, image_mask_pixels_;
  FrameMaps maps_;
};

}  // namespace hermite::frame
