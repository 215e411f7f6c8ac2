// Properties of sensors other than a Kinect v1, and faults of drivers and cables. For tests of
// tracking; the ground truth is unchanged.
//
// Appended to any source (open_sequence), with or without options:
//   +flying         at the edges of objects depth is between both sides, as measured by
//                   time-of-flight cameras
//     width_px      1 to 8 (2)      up to this distance from the edge
//   +lowres         depth is measured at every n-th pixel in each direction and interpolated
//                   between, as on phones
//     every         2 to 16 (4)
//   +speckle        another projector in the room: pixels without depth, and pixels with a random
//                   depth
//     holes         0 to 0.9 (0.2)  share of the pixels
//     wild          0 to 0.5 (0.01) share of the pixels whose depth is random from 0.5 m to 5 m
//     seed          whole (1)
//   +frozen         of every `every` frames the last `count` repeat the images of the one before
//                   them
//     every         2 to 1000 (15)
//     count         1 to 999 (3), less than `every`
//   +misregistered  the colour image is shifted relative to depth, as with a wrong pose of the
//                   colour camera
//     right_px      -40 to 40 (4)   whole pixels
//     down_px       -40 to 40 (0)
//   +banding        mains-powered lamps and a rolling shutter: bands of brightness that move
//                   through the colour image
//     amplitude     0 to 0.9 (0.15)
//     bands         0.5 to 20 (2)   per image height
//   +dark           little light: colour times `gain`, with the noise of photons and amplifier
//     gain          0.01 to 1 (0.1)
//     sigma         0 to 50 (4)     grey values
//     seed          whole (1)
#pragma once

#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

// `options` is "key=value,..." or empty. kInvalidArgument, naming key and range.
Result<std::unique_ptr<dataset::Sequence>> with_flying(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_lowres(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_speckle(std::unique_ptr<dataset::Sequence> sequence,
                                                        const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_frozen(std::unique_ptr<dataset::Sequence> sequence,
                                                       const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_misregistered(
    std::unique_ptr<dataset::Sequence> sequence, const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_banding(std::unique_ptr<dataset::Sequence> sequence,
                                                        const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_dark(std::unique_ptr<dataset::Sequence> sequence,
                                                     const std::string& options);

}  // namespace hermite::disturb
