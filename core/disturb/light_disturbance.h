// Light that changes while a scan goes on, for tests of tracking by colour; depth and ground truth
// are unchanged.
//
// Appended to any source (open_sequence), with or without options:
//   +headlamp     the light moves with the camera: what is near or in the middle of the image is
//                 bright
//     ambient     0 to 1 (0.2)      the part of the light that does not move
//     reference_m 0.1 to 10 (1.8)   from this distance the middle of the image is as bright as in
//                                   the original
//   +lamp         from one moment on, the left half of the scene is dark, as when one of two lamps
//                 is switched off
//     at_s        0 to 3600 (2)     from the first frame
//     dim         0 to 1 (0.4)      gain far to the left of the middle of the scene; the transition
//                                   is 1 m wide
//   +sun          a bright spot, as of the sun between leaves, that moves over the surfaces
//     gain        1 to 4 (1.8)
//     width_m     0.05 to 5 (0.6)
//     speed_m_s   0 to 2 (0.3)
//   +balance      the white balance of the camera: red times 1 + amplitude * sin(2 pi t /
//                 period_s), blue times 1 - the same
//     amplitude   0 to 0.9 (0.2)
//     period_s    0.01 to 3600 (3)
// Gains apply to the sRGB bytes; results are clamped to 0 to 255. The colour becomes a JPEG.
// "+lamp" and "+sun" need ground truth and depth registered to colour, and are placed relative to
// the middle frame (true_view.h).
#pragma once

#include <memory>
#include <string>

#include "core/dataset/sequence.h"

namespace hermite::disturb {

// `options` is "key=value,..." or empty. kInvalidArgument, naming key and range; kUnsupported when
// depth is not registered to colour. A frame without a true pose within 0.1 s is an error of that
// frame.
Result<std::unique_ptr<dataset::Sequence>> with_headlamp(
    std::unique_ptr<dataset::Sequence> sequence, const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_lamp(std::unique_ptr<dataset::Sequence> sequence,
                                                     const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_sun(std::unique_ptr<dataset::Sequence> sequence,
                                                    const std::string& options);
Result<std::unique_ptr<dataset::Sequence>> with_balance(std::unique_ptr<dataset::Sequence> sequence,
                                                        const std::string& options);

}  // namespace hermite::disturb
