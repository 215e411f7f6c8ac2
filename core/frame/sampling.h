// Pixel sampling. A sensor observes a surface 30 times a second, so processing a different quarter
// of the pixels in each frame covers all of them within four frames at a quarter of the cost.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/math/camera.h"
#include "shaders/shared/types.h"

namespace hermite::frame {

// Returns the step for images of this size. Small images are always taken completely: a quarter of
// VGA is as many pixels as tracking needs.
int sampling_step(const Camera& camera, int wished_step);

// `step` 1 takes all pixels; 2 takes a quarter of them, the four quarters in turn.
shared::Sampling sampling_of_frame(int step, std::int64_t frame_index);

// Pinhole cameras of the whole image, of its sampled pixels, and of the next coarser pyramid level,
// where a pixel's centre is the centre of 2x2 finer ones.
shared::Intrinsics intrinsics_of(const Camera& camera);
shared::Intrinsics sampled(const shared::Intrinsics& camera, const shared::Sampling& sampling);
shared::Intrinsics coarser(const shared::Intrinsics& camera);

// Returns the number of elements of this camera's kernel image with its margins; see
// shaders/lib/kernels.glsl.
std::size_t kernel_image_size(const shared::Intrinsics& camera);

}  // namespace hermite::frame
