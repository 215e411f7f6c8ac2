// Errors of depth cameras and their calibration, and cameras that deliver little, for tests of
// tracking; the ground truth is unchanged.
//
// Appended to any source (open_sequence), with or without options:
//   +bend       depth times 1 + percent / 100 * the squared distance from the middle of the image,
//               1 in the corners
//     percent   -10 to 10 (1.5)
//   +sparse     depth only where the image has most texture, in blobs, as from stereo
//     keep      0.01 to 1 (0.1)     share of the pixels with depth that is kept
//   +reach      the depth camera measures only within limits; what is nearer is as missing as what
//               is farther
//     min_m     0 to 10 (1.5)
//     max_m     0.1 to 100 (10)
//   +focal      the stated focal length of the camera differs from the true one
//     percent   -40 to 40 (1)
//   +skip       only every n-th frame is present
//     every     2 to 1000 (3)
#pragma once

#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

// `options` is "key=value,..." or empty. kInvalidArgument, naming key and range.
Result<std::unique_ptr<dataset::Sequence>> with_bend(std::unique_ptr<dataset::Sequence> sequence,
                                                     const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_sparse(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_reach(std::unique_ptr<dataset::Sequence> sequence,
                                                      const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_focal(std::unique_ptr<dataset::Sequence> sequence,
                                                      const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_skip(std::unique_ptr<dataset::Sequence> sequence,
                                                     const std::string& options);

}  // namespace hermite::disturb
