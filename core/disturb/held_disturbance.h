// How a camera is held and what it feels of it, for tests of where up is; what the images show is
// unchanged.
//
// Appended to any source (open_sequence), with or without options:
//   +turned         the camera is held turned about its viewing direction, as a telephone is held
//                   upright; of a camera without distortion, own colour camera and rolling shutter
//     deg           90, 180 or 270 (90)   clockwise as seen by who holds it
//   +accelerometer  the camera has one; the source needs a ground truth whose world has z upwards,
//                   as that of synthetic scenes and of the TUM benchmark
//     noise_m_s2    0 to 10 (0.1)         of a frame's mean, each component
//     bias_m_s2     0 to 5 (0.3)          length of a constant error, about a direction by the seed
//     seed          0 to 2^63 - 1 (1)
#pragma once

#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

// `options` is "key=value,..." or empty. kInvalidArgument, naming key and range, or what the
// sequence lacks.
Result<std::unique_ptr<dataset::Sequence>> with_turned(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_accelerometer(
    std::unique_ptr<dataset::Sequence> sequence, const std::string& options);

}  // namespace hermite::disturb
