// A recording and a trajectory as what a texture is made from.
#pragma once

#include "core/dataset/sequence.h"
#include "core/dataset/trajectory.h"
#include "core/texture/texture_options.h"

namespace hermite {

// Images are straightened in the camera that took them: where colour has a camera of its own, that one with its pose, so that no colour
// goes through the depth image. A frame without a pose at its time, to 0.1 ms, was lost. `sequence` must outlive the result.
TextureFrames texture_frames_of(const Sequence& sequence, const Trajectory& trajectory);

}  // namespace hermite
