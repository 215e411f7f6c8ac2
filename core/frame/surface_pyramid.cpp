#include "core/frame/surface_pyramid.h"

#include <cmath>

#include "core/gpu/buffer_bytes.h"

namespace hermite::frame {

namespace {

template <class Pyramid, class Work>
void for_each_buffer(Pyramid& pyramid, Work work) {
  for (auto& level : pyramid.levels) {
    work(level.points);
    work(level.intensity);
  }
}

}  // namespace

SurfacePyramid make_surface_pyramid(gpu::Device& device, const shared::Intrinsics& finest,
                                    const std::string& purpose) {
  SurfacePyramid pyramid;
  shared::Intrinsics camera = finest;
  for (SurfaceLevel& level : pyramid.levels) {
    const std::size_t pixels = static_cast<std::size_t>(camera.width) * camera.height;
    level = {camera, {device, pixels, purpose}, {device, pixels, purpose}};
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
  for_each_buffer(pyramid, [&bytes](const auto& buffer) { gpu::save(bytes, buffer); });
}

void restore(ByteReader& bytes, SurfacePyramid& pyramid) {
  const shared::Intrinsics& own = pyramid.levels[0].camera;
  shared::Intrinsics camera{};
  bytes.number(camera);
  bytes.require(camera.width == own.width && camera.height == own.height &&
                    std::isfinite(camera.fx) && std::isfinite(camera.fy) &&
                    std::isfinite(camera.cx) && std::isfinite(camera.cy),
                "the camera of a surface is invalid or has another size");
  if (bytes.ok()) set_camera(pyramid, camera);
  for_each_buffer(pyramid, [&bytes](auto& buffer) { gpu::restore(bytes, buffer); });
}

void downsample(gpu::Commands& commands, const gpu::Kernel& kernel, SurfacePyramid& pyramid,
                double depth_gate_m) {
  for (std::size_t level = 1; level < pyramid.levels.size(); ++level) {
    SurfaceLevel& fine = pyramid.levels[level - 1];
    SurfaceLevel& coarse = pyramid.levels[level];
    const shared::DownsampleParams params{coarse.camera.width, coarse.camera.height,
                                          fine.camera.width, static_cast<float>(depth_gate_m)};
    commands.dispatch(kernel, {coarse.camera.width, coarse.camera.height}, params,
                      {{"fine_points", fine.points},
                       {"fine_intensity", fine.intensity},
                       {"points", coarse.points},
                       {"intensity", coarse.intensity}});
  }
}

}  // namespace hermite::frame
