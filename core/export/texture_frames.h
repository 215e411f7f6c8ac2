// Frames of a recording with a trajectory, as input for texturing.
#pragma once

#include "core/dataset/sequence.h"
#include "core/dataset/trajectory.h"
#include "core/texture/texture_options.h"

namespace hermite::exports {

// Images are rectified in the camera that took them: a separate colour camera keeps its own
// intrinsics and pose, so that colours are not resampled through the depth image. A frame without a
// pose within 0.1 ms is lost. `sequence` must outlive the result.
texture::TextureFrames texture_frames_of(const dataset::Sequence& sequence,
                                         const dataset::Trajectory& trajectory);

}  // namespace hermite::exports
