// A lens whose distortion nobody stated, for tests of tracking; the ground truth is unchanged.
//
// Appended to any source (open_sequence), with or without options:
//   +lens       both images are distorted (core/math/camera.h), and the camera does not say so
//     k1        -0.4 to 0.4 (-0.05), negative: barrel
//     k2        -0.4 to 0.4 (0)
#pragma once

#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

// `options` is "key=value,..." or empty. kInvalidArgument, naming key and range.
Result<std::unique_ptr<dataset::Sequence>> with_lens(std::unique_ptr<dataset::Sequence> sequence,
                                                     const std::string& options);

}  // namespace hermite::disturb
