// Renders the depth image of triangles from any viewpoint. Pure function.
#pragma once

#include <vector>

#include "core/base/image.h"
#include "core/evaluate/triangle_surface.h"

namespace hermite::evaluate {

// Nearer surfaces are not drawn.
inline constexpr double kNearestDrawnDepth_m = 0.05;

// Returns, at every pixel centre, the depth along the optical axis of the nearest triangle [m],
// seen from either side; 0 if there is none. Triangles that are not finite are ignored. The
// camera's distortion is not applied: the image is the undistorted one.
Image<float> drawn_depth_m(const std::vector<Triangle>& triangles_in_world, const Camera& camera,
                           const Rigid3& world_from_camera);

}  // namespace hermite::evaluate
