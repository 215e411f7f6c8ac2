// Writes surfels as 3D Gaussians (Kerbl et al., "3D Gaussian Splatting for Real-Time Radiance Field
// Rendering", 2023), in the PLY format of its authors' programs and SuperSplat: x y z nx ny nz
// f_dc_0..2 opacity scale_0..2 rot_0..3, all float. The world is the scan's own (y down), which
// those programs expect. Nothing is optimised: it is the cloud without gaps.
//
//   colour     f_dc, the spherical harmonics of degree 0: (sRGB / 255 - 0.5) / 0.28209
//   opacity    0.95 as its logit: at the centre of four points, where it is least, 6 % of the light
//              passes through all of them
//   scale      logarithms of the standard deviations [m] along the axes of rot: two are
//              kSplatSigmas times the spacing of the points (spacing.h), the third is the
//              thickness. A surfel's radius is the reach of its kernel, about 4 pixels at its
//              depth, so splats of that size would blur finer detail; but it limits the spacing of
//              a point with few neighbours.
//   thickness  a tenth of that, or the deviation of the curved surface within it, if larger
//   rotation   a quaternion, w first, that rotates the third axis to the normal
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite::output {

// A share of the spacing. At the centre of four points of a square grid, each has exp(-0.25 /
// 0.6^2), half of its weight: narrower splats leave gaps, wider ones blur.
inline constexpr float kSplatSigmas = 0.6f;

// Returns kInvalidArgument as check_cloud_with_points, or for a point without a normal.
Result<std::string> format_splats(const Cloud& cloud);

}  // namespace hermite::output
