// Surfels as 3D Gaussians (Kerbl et al., "3D Gaussian Splatting for Real-Time Radiance Field Rendering", 2023), in the PLY that its
// programs and SuperSplat read: x y z nx ny nz f_dc_0..2 opacity scale_0..2 rot_0..3, all float. The world is the scan's own (y down),
// which those programs expect. Nothing is trained: it is the cloud without gaps.
//
//   colour     f_dc, the spherical harmonics of degree 0: (sRGB / 255 - 0.5) / 0.28209
//   opacity    0.95 as its logit: in the middle of four points, where it is least, 6 % of the light pass through all that lie there
//   scale      logarithms of the standard deviations [m] along the axes that rot turns: two are kSplatSigmas times the spacing of the
//              points (spacing.h), the third is the thickness. Not by the surfel's radius: that is the reach of its kernel, about 4 pixels
//              at its depth, and splats as wide would blur what is finer; but it bounds the spacing of a point that has few neighbours.
//   thickness  a tenth of that, or how far the surface bends away within it, if that is more
//   rotation   a quaternion, w first, that turns the third axis into the normal
#pragma once

#include <string>

#include "core/base/result.h"
#include "core/output/cloud.h"

namespace hermite {

// Of the spacing. In the middle of four points of a square grid each still has exp(-0.25 / 0.6^2) = half of its weight: narrower ones leave
// gaps, wider ones blur.
inline constexpr float kSplatSigmas = 0.6f;

// kInvalidArgument: check_cloud_with_points, or a point without a normal.
Result<std::string> format_splats(const Cloud& cloud);

}  // namespace hermite
