#include "core/map/predict.h"

#include "core/frame/sampling.h"

namespace hermite::map {

namespace {

// A lambda far above every curvature (frame.curvature_limit_per_m is at most 1e4), so that all
// surface counts as flat.
constexpr float kNothingIsCurved_per_m = 1e6f;

}  // namespace

Predictor::Predictor(gpu::Device& device, const shared::Intrinsics& camera,
                     const MapOptions& options)
    : options_(options),
      describe_(device, "map/kernels"),
      predict_(device, "map/predict", {static_cast<std::uint32_t>(options.window / 2)}),
      fill_in_(device, "map/fill_in"),
      kernels_(device, frame::kernel_image_size(camera), "prediction"),
      covered_pixel_count_(device, 1, "prediction"),
      surface_(frame::make_surface_pyramid(device, camera, "prediction")) {}

void Predictor::run(gpu::Commands& commands, const SurfelStore& store, const IndexMap& stable,
                    const frame::FrameMaps& frame, FillIn fill_in,
                    const frame::Brightness& brightness) {
  frame::SurfaceLevel& out = surface_.levels[0];
  const frame::SurfaceLevel& own = frame.surface.levels[0];
  frame::set_camera(surface_, own.camera);
  const float lambda_per_m = options_.curvature_weight
                                 ? static_cast<float>(options_.curvature_lambda_per_m)
                                 : kNothingIsCurved_per_m;
  const float confidence_scale = static_cast<float>(options_.confidence_scale);
  const shared::uint pixels = out.camera.width * out.camera.height;

  commands.dispatch(describe_, {out.camera.width, out.camera.height}, out.camera,
                    {{"position_confidence", store.positions},
                     {"attributes", store.attributes},
                     {"camera_from_submap", store.camera_from_submap},
                     {"nearest", stable.nearest()},
                     {"kernels", kernels_}});
  commands.fill(covered_pixel_count_, 0);
  // Four pixels per invocation.
  commands.dispatch(
      predict_, {(out.camera.width + 3) / 4, out.camera.height},
      shared::PredictParams{out.camera, lambda_per_m, confidence_scale,
                            static_cast<shared::uint>(options_.min_support),
                            static_cast<shared::uint>(options_.max_iterations),
                            options_.correct_bias ? 1u : 0u, options_.hrbf_prediction ? 1u : 0u},
      {{"position_confidence", store.positions},
       {"attributes", store.attributes},
       {"kernels", kernels_},
       {"nearest", stable.nearest()},
       {"points", out.points},
       {"intensity", out.intensity},
       {"covered_count", covered_pixel_count_}});
  if (fill_in == FillIn::kNothing) return;
  commands.dispatch(
      fill_in_, {pixels},
      shared::FillInParams{
          pixels, lambda_per_m, confidence_scale,
          static_cast<shared::uint>(options_.fill_in_below * static_cast<double>(pixels)),
          fill_in == FillIn::kSurfaceAndColor ? 1u : 0u, static_cast<float>(brightness.gain),
          static_cast<float>(brightness.offset)},
      {{"frame_points", own.points},
       {"frame_intensity", own.intensity},
       {"points", out.points},
       {"intensity", out.intensity},
       {"covered_count", covered_pixel_count_}});
}

}  // namespace hermite::map
