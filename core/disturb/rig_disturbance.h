// What a rig, a cable or a clock does to the frames of a camera, for tests of tracking; the true
// poses are unchanged.
//
// Appended to any source (open_sequence), with or without options:
//   +attached     a part of the rig in the lower right corner of each image, at a fixed distance
//                 from the camera
//     share       0.01 to 0.5 (0.15)  of the image
//     distance_m  0.2 to 5 (0.5)
//   +torn         an incomplete transfer: below one row, both images are those of the frame before
//     every       1 to 1000 (5)       every n-th frame is torn, at a different row each time
//     seed        whole (1)
//   +stained      dirt on the lens: spots of the image without depth, whose colour is dark and
//                 blurred
//     spots       1 to 100 (6)
//     width_px    2 to 200 (30)
//     seed        whole (1)
//   +warming      depth times 1 + percent / 100 * t / over_s: a sensor that becomes warm
//     percent     -10 to 10 (1)
//     over_s      0.1 to 3600 (5)     constant from then on
//   +jitter       time stamps of arrival instead of exposure: uniformly distributed delays
//     ms          0 to 1000 (12)      at most; stamps still increase, and the ground truth has
//                                     them, too
//     seed        whole (1)
#pragma once

#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

// `options` is "key=value,..." or empty. kInvalidArgument, naming key and range.
Result<std::unique_ptr<dataset::Sequence>> with_attached(
    std::unique_ptr<dataset::Sequence> sequence, const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_torn(std::unique_ptr<dataset::Sequence> sequence,
                                                     const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_stained(std::unique_ptr<dataset::Sequence> sequence,
                                                        const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_warming(std::unique_ptr<dataset::Sequence> sequence,
                                                        const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_jitter(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options);

}  // namespace hermite::disturb
