#include "core/frame/surface_pyramid.h"

#include <cmath>

namespace hermite {

shared::Intrinsics intrinsics_of_level(const Camera& camera, int level) {
  const double scale = std::ldexp(1.0, -level);
  const auto principal = [scale](double c) { return static_cast<float>((c + 0.5) * scale - 0.5); };
  return {static_cast<float>(camera.fx * scale), static_cast<float>(camera.fy * scale), principal(camera.cx), principal(camera.cy),
          static_cast<shared::uint>(camera.width >> level), static_cast<shared::uint>(camera.height >> level)};
}

SurfacePyramid make_surface_pyramid(gpu::Device& device, const Camera& camera, const std::string& purpose) {
  SurfacePyramid pyramid;
  for (int level = 0; level < kPyramidLevels; ++level) {
    const shared::Intrinsics intrinsics = intrinsics_of_level(camera, level);
    const std::size_t pixels = static_cast<std::size_t>(intrinsics.width) * intrinsics.height;
    pyramid.levels[static_cast<std::size_t>(level)] = {intrinsics, {device, pixels, purpose}, {device, pixels, purpose},
                                                       {device, pixels, purpose}, {device, pixels, purpose}, {device, pixels, purpose}};
  }
  return pyramid;
}

void downsample(gpu::Commands& commands, const gpu::Kernel& kernel, SurfacePyramid& pyramid, double depth_gate_m) {
  for (std::size_t level = 1; level < pyramid.levels.size(); ++level) {
    SurfaceLevel& fine = pyramid.levels[level - 1];
    SurfaceLevel& coarse = pyramid.levels[level];
    const shared::DownsampleParams params{coarse.camera.width, coarse.camera.height, fine.camera.width, static_cast<float>(depth_gate_m)};
    commands.dispatch(kernel, {coarse.camera.width, coarse.camera.height}, params,
                      {fine.depth_m, fine.normals, fine.curvatures, fine.weight, fine.intensity, coarse.depth_m, coarse.normals,
                       coarse.curvatures, coarse.weight, coarse.intensity});
  }
}

}  // namespace hermite
