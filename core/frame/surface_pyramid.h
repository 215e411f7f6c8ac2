// A surface seen from one pose at three resolutions, of a frame or of the map's prediction, as
// odometry compares them.
#pragma once

#include <array>
#include <string>

#include "core/base/byte_stream.h"
#include "core/frame/sampling.h"
#include "core/gpu/buffer.h"
#include "core/gpu/commands.h"
#include "core/gpu/kernel.h"
#include "shaders/shared/frame.h"

namespace hermite::frame {

inline constexpr int kPyramidLevels = 3;

// Row major, camera.width * camera.height entries each.
struct SurfaceLevel {
  shared::Intrinsics camera;
  gpu::Buffer<shared::SurfacePoint> points;
  gpu::Buffer<float> intensity;  // grey, 0 to 255; -1: no colour here
};

struct SurfacePyramid {
  std::array<SurfaceLevel, kPyramidLevels> levels;
};

SurfacePyramid make_surface_pyramid(gpu::Device& device, const shared::Intrinsics& finest,
                                    const std::string& purpose);

// Sets another camera of the same size, as when other pixels are sampled.
void set_camera(SurfacePyramid& pyramid, const shared::Intrinsics& finest);

// Saves all levels between submissions.
void save(ByteWriter& bytes, const SurfacePyramid& pyramid);

// Restores into a pyramid of the same size; the reader fails otherwise.
void restore(ByteReader& bytes, SurfacePyramid& pyramid);

// Records the passes that compute levels 1 and 2 from level 0.
void downsample(gpu::Commands& commands, const gpu::Kernel& kernel, SurfacePyramid& pyramid,
                double depth_gate_m);

}  // namespace hermite::frame
