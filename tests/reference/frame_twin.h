// The passes of shaders/frame once more, on the CPU in double precision and from the formulas
// (paper section 3.2 to 3.4), with loops instead of tiles. Each takes the downloaded input of its
// pass, so a difference is that pass's own. Pure functions.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/frame/frame_options.h"
#include "core/math/hrbf.h"
#include "tests/support/surface_image.h"

namespace hermite::test {

// Filtered depth [m] from measured depth [m], 0 = nothing.
std::vector<double> bilateral_twin(const std::vector<float>& raw_depth_m,
                                   const shared::Intrinsics& camera,
                                   const frame::FrameOptions& options);

// Unit normals by central differences, zero where there is none.
std::vector<Eigen::Vector3d> normals_twin(const std::vector<float>& depth_m,
                                          const shared::Intrinsics& camera, double depth_gate_m);

// The HRBF surface of a frame; intensity is left empty.
SurfaceImage surface_twin(const std::vector<float>& depth_m,
                          const std::vector<Eigen::Vector3d>& normals,
                          const shared::Intrinsics& camera, const frame::FrameOptions& options);

// Half the resolution: means of 2x2 pixels.
SurfaceImage downsample_twin(const SurfaceImage& fine, const shared::Intrinsics& coarse_camera,
                             double depth_gate_m);

// Sobel, grey values per pixel, zero on the border.
std::vector<Eigen::Vector2d> gradient_twin(const std::vector<float>& intensity,
                                           const shared::Intrinsics& camera);

// scale pixel diagonals, up to twice that on slanted surfaces.
double support_radius_m(const shared::Intrinsics& camera, double scale, double depth_m,
                        double normal_z);

}  // namespace hermite::test
