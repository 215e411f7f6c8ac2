// Surfaces given by formulas, seen by a camera without noise: the truth for tests of passes. Pure
// functions.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>

#include "core/frame/rgbd_frame.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "tests/support/surface_image.h"

namespace hermite::test {

struct SceneHit {
  // World; the normal is unit and points away from the ray's origin.
  Eigen::Vector3d position_m, normal;
};
// Where a ray (origin, direction of any length) first meets the surface.
using Scene = std::function<std::optional<SceneHit>(const Eigen::Vector3d& origin_m,
                                                    const Eigen::Vector3d& direction)>;

// Meets the z axis at depth_m; its normal is turned by tilt_rad from the z axis towards x.
Scene plane_scene(double depth_m, double tilt_rad = 0);
// Its nearest point is (0, 0, depth_m).
Scene sphere_scene(double depth_m, double radius_m);
// Seen from inside: its farthest point is (0, 0, depth_m).
Scene bowl_scene(double depth_m, double radius_m);
// Gentle waves in both directions around z = depth_m: determines all six degrees of freedom of a
// camera.
Scene wave_scene(double depth_m);

// Smooth grey texture, 28 to 228, with waves of a few centimetres.
double texture(const Eigen::Vector3d& point_m);

// Depth, normals and grey values at the pixel centres of a level, weight 1, no curvature.
SurfaceImage render(const Scene& scene, const shared::Intrinsics& camera,
                    const Rigid3& world_from_camera = {});

// What a sensor without noise sees; 0 beyond 16 bits.
DepthImage render_depth(const Scene& scene, const Camera& camera);

// Depth and a flat colour.
frame::RgbdFrame grey_frame(DepthImage depth, Rgb8 color = {128, 128, 128});

}  // namespace hermite::test
