// What sensors other than a Kinect v1 do, and what drivers and cables do. For tests of tracking; the ground truth stays as it is.
//
// Written behind any source (open_sequence), with or without options:
//   +flying         at the edges of things depth lies between both sides, as time-of-flight cameras measure it
//     width_px      1 to 8 (2)      so far from the edge
//   +lowres         depth is measured at every so-many-th pixel each way and interpolated between, as telephones do it
//     every         2 to 16 (4)
//   +speckle        another projector in the room: pixels without depth, and pixels with the depth of nothing
//     holes         0 to 0.9 (0.2)  share of the pixels
//     wild          0 to 0.5 (0.01) share of the pixels whose depth is anything from 0.5 m to 5 m
//     seed          whole (1)
//   +frozen         of every `every` frames the last `count` show the images of the one before them once more
//     every         2 to 1000 (15)
//     count         1 to 999 (3), less than `every`
//   +misregistered  the colour image is shifted against depth, as with a wrong pose of the colour camera
//     right_px      -40 to 40 (4)   whole pixels
//     down_px       -40 to 40 (0)
//   +banding        lamps at the mains and a rolling shutter: bands of brightness that wander through the colour image
//     amplitude     0 to 0.9 (0.15)
//     bands         0.5 to 20 (2)   in the image's height
//   +dark           little light: colour times `gain`, with the noise of photons and amplifier
//     gain          0.01 to 1 (0.1)
//     sigma         0 to 50 (4)     grey values
//     seed          whole (1)
#pragma once

#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite {

// `options` is "key=value,...", may be empty. kInvalidArgument, naming key and range.
Result<std::unique_ptr<Sequence>> with_flying(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_lowres(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_speckle(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_frozen(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_misregistered(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_banding(std::unique_ptr<Sequence> sequence, const std::string& options);
Result<std::unique_ptr<Sequence>> with_dark(std::unique_ptr<Sequence> sequence, const std::string& options);

}  // namespace hermite
