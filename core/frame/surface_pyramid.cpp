#include "core/frame/surface_pyramid.h"

#include <cmath>

#include "core/gpu/buffer_bytes.h"

namespace hermite {

SurfacePyramid make_surface_pyramid(gpu::Device& device, const shared::Intrinsics& finest, const std::string& purpose) {
  SurfacePyramid pyramid;
  shared::Intrinsics camera = finest;
  for (SurfaceLevel& level : pyramid.levels) {
    const std::size_t pixels = static_cast<std::size_t>(camera.width) * camera.height;
    level = {camera,
             {device, pixels, purpose},
             {device, pixels, purpose},
             {device, pixels, purpose},
             {device, pixels, purpose},
             {device, pixels, purpose}};
    camera = coarser(camera);
  }
  return pyramid;
}

void set_camera(SurfacePyramid& pyramid, const shared::Intrinsics& finest) {
  shared::Intrinsics camera = finest;
  for (SurfaceLevel& level : pyramid.levels) {
    level.camera = camera;
    camera = coarser(camera);
  }
}

void save(ByteWriter& bytes, const SurfacePyramid& pyramid) {
  bytes.number(pyramid.levels[0].camera);
  for (const SurfaceLevel& level : pyramid.levels) {
    gpu::save(bytes, level.depth_m);
    gpu::save(bytes, level.normals);
    gpu::save(bytes, level.curvatures);
    gpu::save(bytes, level.weight);
    gpu::save(bytes, level.intensity);
  }
}

void restore(ByteReader& bytes, SurfacePyramid& pyramid) {
  const shared::Intrinsics& own = pyramid.levels[0].camera;
  shared::Intrinsics camera{};
  bytes.number(camera);
  bytes.require(camera.width == own.width && camera.height == own.height && std::isfinite(camera.fx) && std::isfinite(camera.fy) &&
                    std::isfinite(camera.cx) && std::isfinite(camera.cy),
                "the camera of a surface");
  if (bytes.ok()) set_camera(pyramid, camera);
  for (SurfaceLevel& level : pyramid.levels) {
    gpu::restore(bytes, level.depth_m);
    gpu::restore(bytes, level.normals);
    gpu::restore(bytes, level.curvatures);
    gpu::restore(bytes, level.weight);
    gpu::restore(bytes, level.intensity);
  }
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
