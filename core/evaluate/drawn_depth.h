// The depth image of triangles from anywhere. Pure function.
#pragma once

#include <vector>

#include "core/base/image.h"
#include "core/evaluate/triangle_surface.h"

namespace hermite {

// What lies nearer is not drawn.
inline constexpr double kNearestDrawnDepth_m = 0.05;

// Depth along the optical axis of the nearest triangle at every pixel centre [m], both of its sides seen; 0 where there is none. Triangles
// that are not finite are left out. The lens of the camera is not drawn: its image is the straight one.
Image<float> drawn_depth_m(const std::vector<Triangle>& triangles_in_world, const Camera& camera, const Rigid3& world_from_camera);

}  // namespace hermite
