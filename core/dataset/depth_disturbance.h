// What depth cameras and their calibration do wrong, and cameras that deliver little. For tests of tracking; the ground truth stays as it
// is.
//
// Written behind any source (open_sequence), with or without options:
//   +bend       depth times 1 + percent / 100 * the squared distance from the middle of the image, 1 in the corners
//     percent   -10 to 10 (1.5)
//   +sparse     only where the picture has most texture, in blobs, as of stereo
//     keep      0.01 to 1 (0.1)     share of the pixels with depth that is kept
//   +focal      the camera is said to have another focal length than it has
//     percent   -10 to 10 (1)
//   +skip       every so-many-th frame alone is there
//     every     2 to 1000 (3)
#pragma once

#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite {

// `options` is "key=value,...", may be empty. kInvalidArgument, naming key and range.
Result<std::unique_ptr<Sequence>> with_bend(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_sparse(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_focal(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_skip(std::unique_ptr<Sequence> sequence, const std::string& options);

}  // namespace hermite
