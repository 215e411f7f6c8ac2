#include "core/frame/preprocess.h"

#include <algorithm>
#include <cmath>

#include "core/base/frame_helpers.h"

namespace hermite::frame {

namespace {

// The paper's epsilon "reflects the resolution" of a Kinect v1. The gradient decreases with the
// footprint of pixels, so epsilon scales with the focal length; otherwise the same surface would
// get less confidence from a coarser camera, and a small image would never produce stable surfels.
constexpr double kKinectFocalLength_px = 525;

FrameMaps make_frame_maps(gpu::Device& device, const Camera& camera, int step) {
  const shared::Intrinsics finest = sampled(intrinsics_of(camera), sampling_of_frame(step, 0));
  const std::size_t pixels = static_cast<std::size_t>(finest.width) * finest.height;
  FrameMaps maps{{device, pixels, "frame"},
                 {device, pixels, "frame"},
                 {device, kernel_image_size(finest), "frame"},
                 {device, pixels, "frame"},
                 make_surface_pyramid(device, finest, "frame"),
                 {}};
  for (std::size_t level = 0; level < maps.images.size(); ++level)
    maps.images[level] = {device, maps.surface.levels[level].intensity.count(), "frame"};
  return maps;
}

// Returns the number of pixels of the depth image with its margin.
std::size_t depth_image_size(const Camera& camera) {
  return static_cast<std::size_t>(HERMITE_DEPTH_STRIDE(camera.width)) *
         static_cast<std::size_t>(camera.height + 2 * HERMITE_DEPTH_MARGIN);
}

Rgb8 brightened(const Rgb8& color, float darkening) {
  const auto bright = [darkening](std::uint8_t value) {
    return static_cast<std::uint8_t>(
        std::min(255.0f, static_cast<float>(value) / darkening + 0.5f));
  };
  return {bright(color.r), bright(color.g), bright(color.b)};
}

// The window ends where the Gaussian has fallen to about 0.4 (radius 6 for 4.5 px, as in the
// authors' program).
std::uint32_t window_radius(const FrameOptions& options) {
  const double correlated_px = options.measure_noise ? options.bilateral_correlated_space_px : 0;
  return static_cast<std::uint32_t>(
      std::lround(std::max(options.bilateral_sigma_space_px, correlated_px) * 4.0 / 3.0));
}

}  // namespace

Preprocessor::Preprocessor(gpu::Device& device, const Camera& camera, const FrameOptions& options)
    : camera_(camera),
      options_(options),
      step_(sampling_step(camera, options.sampling)),
      filter_(filter_widths(options, SensorNoise{})),
      inverse_depth_(device, "frame/inverse_depth"),
      bilateral_(device, "frame/bilateral",
                 {window_radius(options), static_cast<std::uint32_t>(step_)}),
      normals_(device, "frame/normals"),
      surface_(device, "frame/surface"),
      intensity_(device, "frame/intensity"),
      gradient_(device, "frame/gradient"),
      downsample_(device, "frame/downsample"),
      mask_(device, "frame/mask"),
      mask_image_(device, "frame/mask_image"),
      staged_units_(depth_image_size(camera)),
      units_(device, staged_units_.size() / 8, "frame"),
      inverse_depth_per_m_(device, staged_units_.size() / 4, "frame"),
      staged_color_(static_cast<std::size_t>(camera.width) *
                    static_cast<std::size_t>(camera.height)),
      color_(device, staged_color_.size(), "frame"),
      maps_(make_frame_maps(device, camera, step_)) {
  for (gpu::Buffer<shared::uint>* pixels : {&mask_pixels_, &image_mask_pixels_})
    *pixels = {device, maps_.surface.levels.back().intensity.count(), "frame"};
}

shared::MaskParams Preprocessor::mask_params(std::size_t level) const {
  const shared::Intrinsics &camera = maps_.surface.levels[level].camera,
                           &coarsest = maps_.surface.levels.back().camera;
  return {camera.width, camera.height, coarsest.width, coarsest.height,
          static_cast<shared::uint>(maps_.surface.levels.size() - 1 - level)};
}

void Preprocessor::mask(gpu::Commands& commands, const CoarseMask& mask) {
  mask_pixels_.upload(mask);
  for (std::size_t level = 0; level < maps_.surface.levels.size(); ++level) {
    const shared::MaskParams params = mask_params(level);
    commands.dispatch(mask_, {params.width, params.height}, params,
                      {{"mask", mask_pixels_}, {"points", maps_.surface.levels[level].points}});
  }
}

void Preprocessor::mask_image(gpu::Commands& commands, const CoarseMask& mask) {
  image_mask_pixels_.upload(mask);
  for (std::size_t level = 0; level < maps_.images.size(); ++level) {
    const shared::MaskParams params = mask_params(level);
    commands.dispatch(mask_image_, {params.width, params.height}, params,
                      {{"mask", image_mask_pixels_}, {"image", maps_.images[level]}});
  }
}

void Preprocessor::upload(const RgbdFrame& frame) {
  for (int y = 0; y < frame.depth.height; ++y)
    std::copy_n(&frame.depth.at(0, y), frame.depth.width,
                &staged_units_[static_cast<std::size_t>((y + HERMITE_DEPTH_MARGIN) *
                                                            HERMITE_DEPTH_STRIDE(camera_.width) +
                                                        HERMITE_DEPTH_MARGIN)]);
  units_.upload({reinterpret_cast<const shared::uvec4*>(staged_units_.data()), units_.count()});
  for_pixels_of_frame(staged_color_.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const Rgb8 c = darkening_.empty() ? frame.color.pixels[i]
                                        : brightened(frame.color.pixels[i], darkening_[i]);
      staged_color_[i] = static_cast<shared::uint>(c.r | (c.g << 8) | (c.b << 16));
    }
  });
  color_.upload(staged_color_);
}

const FrameMaps& Preprocessor::run(gpu::Commands& commands, const RgbdFrame& frame,
                                   std::int64_t frame_index) {
  upload(frame);
  const shared::Intrinsics whole = intrinsics_of(camera_);
  const shared::Sampling sampling = sampling_of_frame(step_, frame_index);
  set_camera(maps_.surface, sampled(whole, sampling));
  const shared::Intrinsics& camera = maps_.camera();
  const gpu::Threads image{camera.width, camera.height};
  SurfaceLevel& surface = maps_.surface.levels[0];
  const float depth_gate_m = static_cast<float>(options_.depth_gate_m);

  const gpu::Threads fours{(camera.width + 3) / 4, camera.height};  // four pixels per invocation
  const auto texels = static_cast<shared::uint>(units_.count());
  commands.dispatch(
      inverse_depth_, {texels},
      shared::InverseDepthParams{texels, static_cast<float>(1.0 / camera_.depth_units_per_metre),
                                 static_cast<float>(options_.depth_min_m),
                                 static_cast<float>(options_.depth_max_m)},
      {{"units", units_}, {"inverse_depth_per_m", inverse_depth_per_m_}});
  commands.dispatch(
      bilateral_, fours,
      shared::BilateralParams{whole, sampling,
                              static_cast<float>(0.5 / (filter_.space_px * filter_.space_px)),
                              static_cast<float>(options_.noise_floor_m),
                              static_cast<float>(options_.noise_growth_per_m),
                              static_cast<float>(filter_.depth_deviations)},
      {{"inverse_depth_per_m", inverse_depth_per_m_},
       {"raw_m", maps_.raw_depth_m},
       {"filtered_m", maps_.filtered_depth_m}});
  const auto radius_scale = static_cast<float>(options_.support_radius_scale);
  commands.dispatch(normals_, image,
                    shared::NormalParams{camera, 0.5f * depth_gate_m, radius_scale},
                    {{"depth_m", maps_.filtered_depth_m}, {"kernels", maps_.kernels}});
  commands.dispatch(surface_, fours,
                    shared::SurfaceParams{
                        camera, radius_scale, depth_gate_m,
                        static_cast<float>(options_.confidence_epsilon *
                                           static_cast<double>(camera.fx) / kKinectFocalLength_px),
                        static_cast<float>(options_.curvature_limit_per_m),
                        options_.hrbf_confidence ? 1u : 0u, options_.project_to_surface ? 1u : 0u},
                    {{"kernels", maps_.kernels}, {"points", surface.points}});
  commands.dispatch(intensity_, image, shared::IntensityParams{whole, sampling},
                    {{"color", color_},
                     {"intensity", surface.intensity},
                     {"image", maps_.images[0]},
                     {"sampled_color", maps_.color}});
  downsample(commands, downsample_, maps_.surface, 0.5 * options_.depth_gate_m);
  for (std::size_t level = 1; level < maps_.images.size(); ++level) {
    const SurfaceLevel& image_level = maps_.surface.levels[level];
    commands.dispatch(gradient_, {image_level.camera.width, image_level.camera.height},
                      shared::GradientParams{image_level.camera.width, image_level.camera.height},
                      {{"intensity", image_level.intensity}, {"image", maps_.images[level]}});
  }
  return maps_;
}

}  // namespace hermite::frame
