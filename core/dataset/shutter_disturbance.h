// What shutters and clocks do to the images of a camera that moves. For tests of tracking; the ground truth stays that of the time stamps.
//
// Written behind any source that has ground truth and depth registered to colour (open_sequence), with or without options:
//   +rolling   a rolling shutter: each row of depth and colour is taken at a time of its own, the middle of the image at the time stamp
//     ms       0 to 100 (30)      from the first row to the last
//   +clock     colour is taken later than the depth it comes with, which has the time stamp
//     ms       -100 to 100 (16)   negative: earlier
//   +blur      colour is the mean over an exposure whose middle is the time stamp
//     ms       0 to 100 (15)
// Poses between frames are interpolated between those of the ground truth: at 30 of them a second, and a hand's acceleration of 1 m/s^2, to
// 0.2 mm. The images are made of the frame's own pixels (moved_view.h), those of +clock of the frame that is nearest in time; so they lack
// what that frame does not show: some pixels along the border, where depth is missing and colour repeats the border's. Nothing is rendered
// anew, so that recordings and synthetic sources go through the same. Write +noise behind these: noise before them moves with the surfaces.
// Blur averages bytes as they are, sRGB. The colour becomes a JPEG.
#pragma once

#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite {

// `options` is "key=value,...", may be empty. kInvalidArgument, naming key and range; no ground truth. kUnsupported: depth is not
// registered to colour. A frame without a pose within 0.1 s is an error of that frame.
Result<std::unique_ptr<Sequence>> with_rolling(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_clock(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_blur(std::unique_ptr<Sequence> sequence, const std::string& options);

}  // namespace hermite
