// Effects of shutters and clocks on the images of a moving camera. For tests of tracking; the
// ground truth remains that of the time stamps.
//
// Appended to any source that has ground truth and depth registered to colour (open_sequence), with
// or without options:
//   +rolling   a rolling shutter: each row of depth and colour is taken at its own time, the middle
//              of the image at the time stamp
//     ms       0 to 100 (30)      from the first row to the last
//   +clock     colour is taken later than the depth of the same frame, which has the time stamp
//     ms       -100 to 100 (16)   negative: earlier
//   +blur      colour is the mean over an exposure whose middle is the time stamp
//     ms       0 to 100 (15)
// Poses between frames are interpolated from the ground truth: at 30 poses per second and a hand's
// acceleration of 1 m/s^2, to 0.2 mm. The images are made from the frame's own pixels
// (moved_view.h), for +clock from those of the frame that is nearest in time; so they lack what
// that frame does not show: some pixels along the border, where depth is missing and colour repeats
// the border. Nothing is rendered again, so that recordings and synthetic sources are treated
// alike. Append +noise after these: noise before them moves with the surfaces. Blur averages sRGB
// bytes. The colour becomes a JPEG.
#pragma once

#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

// `options` is "key=value,..." or empty. kInvalidArgument, naming key and range, and without ground
// truth; kUnsupported when depth is not registered to colour. A frame without a pose within 0.1 s
// is an error of that frame.
Result<std::unique_ptr<dataset::Sequence>> with_rolling(std::unique_ptr<dataset::Sequence> sequence,
                                                        const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_clock(std::unique_ptr<dataset::Sequence> sequence,
                                                      const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_blur(std::unique_ptr<dataset::Sequence> sequence,
                                                     const std::string& options);

}  // namespace hermite::disturb
