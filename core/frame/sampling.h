// Which pixels a frame is looked at through. A sensor sees a surface 30 times a second: a quarter of its pixels, another quarter in every
// frame, covers all of them within four frames and costs a quarter.
#pragma once

#include <cstddef>
#include <cstdint>

#include "core/math/camera.h"
#include "shaders/shared/types.h"

namespace hermite {

// The step for images of this size. Small ones are taken whole whatever is wished: a quarter of VGA is as many pixels as tracking needs.
int sampling_step(const Camera& camera, int wished_step);

// `step` 1: all pixels. 2: a quarter of them, the four quarters in turn.
shared::Sampling sampling_of_frame(int step, std::int64_t frame_index);

// Pinhole cameras of the whole image, of its sampled pixels, and of a pyramid's next coarser level, where a pixel's centre is the centre
// of 2x2 finer ones.
shared::Intrinsics intrinsics_of(const Camera& camera);
shared::Intrinsics sampled(const shared::Intrinsics& camera, const shared::Sampling& sampling);
shared::Intrinsics coarser(const shared::Intrinsics& camera);

// Elements of an image of kernels of this camera, with its margins: see shaders/lib/kernels.glsl.
std::size_t kernel_image_size(const shared::Intrinsics& camera);

}  // namespace hermite
