// What a camera sees of a mesh: a depth buffer in software. Pure functions, thread-safe.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/image.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/output/triangle_mesh.h"

namespace hermite {

inline constexpr std::uint32_t kNoTriangle = 0xffffffff;
// What is nearer to the lens is not drawn.
inline constexpr double kNearestDrawn_m = 0.05;

struct ViewRaster {
  Image<float> inverse_depth_per_m;  // of the nearest triangle, whichever its side; 0: none
  Image<std::uint32_t> triangle;     // kNoTriangle: none
};

// At the pixel centres of a camera without distortion. Of two triangles at one depth the first is kept. Triangles that are not finite are
// not drawn. Indices are in range (a CHECK of the caller's: textured() has looked).
ViewRaster rasterised(const TriangleMesh& mesh, const Camera& camera, const Rigid3& world_from_camera);

// By pixel: how far it is from where another surface begins, where the mesh ends, or from the border of the image [px], cut off at
// kFarFromEdge_px; 0 where there is no surface. Another surface begins where the inverse depth, which is linear over a plane, bends by more
// than kEdgeBend of itself: planes seen at a slant have none.
inline constexpr int kFarFromEdge_px = 24;
inline constexpr float kEdgeBend = 0.01f;
Image<std::uint8_t> distance_from_edges_px(const Image<float>& inverse_depth_per_m);

// Barycentric weights of what a pixel sees of a triangle, perspective-correct; camera_from_world of the same view.
Eigen::Vector3f weights_in_triangle(const TriangleMesh& mesh, std::uint32_t triangle, const Rigid3& camera_from_world,
                                    const Eigen::Vector3d& ray_in_camera);

}  // namespace hermite
