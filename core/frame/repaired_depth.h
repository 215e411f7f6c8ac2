// Repairs single pixels of a depth image. Sensors lose some, or measure anything there: where a
// second projector shines, on dark cloth, or between the samples of a registered image. Normals,
// planes and the field of a frame need whole windows, of which few are left otherwise. Runs on the
// host.
#pragma once

#include "core/base/image.h"
#include "core/frame/frame_options.h"

namespace hermite::frame {

// First removes depths with which none of the neighbours agrees, of at least two that have depth.
// Then gives a pixel without depth the one between two opposite neighbours that agree, of such
// pairs the closest: on a plane that is exact, since inverse depth is linear over its image. Two
// passes fill gaps of up to two pixels, and 19 of 20 holes of a surface of which half is measured;
// a larger hole loses its corners only. Depths agree if they differ by at most half of
// options.depth_gate_m, as for normals, or by what noise explains. Returns true if anything
// changed. Any thread.
bool repair_depth(DepthImage& depth, double depth_units_per_metre, const FrameOptions& options);

}  // namespace hermite::frame
