// A software rasteriser with a depth buffer: the visible part of a mesh in a camera. Pure
// functions, thread-safe.
#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "core/base/image.h"
#include "core/math/camera.h"
#include "core/math/rigid3.h"
#include "core/output/triangle_mesh.h"

namespace hermite::texture {

inline constexpr std::uint32_t kNoTriangle = 0xffffffff;
// Geometry nearer than this is not drawn.
inline constexpr double kNearestDrawn_m = 0.05;

struct ViewRaster {
  Image<float> inverse_depth_per_m;  // of the nearest triangle, front or back; 0: none
  Image<std::uint32_t> triangle;     // kNoTriangle: none
};

// Samples at the pixel centres of a camera without distortion. Of two triangles at equal depth the
// first wins. Triangles that are not finite are not drawn. The caller has checked that indices are
// in range, as textured() does.
ViewRaster rasterised(const output::TriangleMesh& mesh, const Camera& camera,
                      const Rigid3& world_from_camera);

// Larger distances from an edge of the surface are not told apart.
inline constexpr int kFarFromEdge_px = 24;
// Relative second difference of the inverse depth beyond which there is a discontinuity.
inline constexpr float kEdgeBend = 0.01f;

// Returns, by pixel, the distance [px] to the nearest depth discontinuity, to the end of the mesh
// or to the border of the image, at most kFarFromEdge_px; 0 where there is no surface. A
// discontinuity is where the second difference of the inverse depth, which is linear over a plane,
// exceeds kEdgeBend of its value; slanted planes have none.
Image<std::uint8_t> distance_from_edges_px(const Image<float>& inverse_depth_per_m);

// Returns the perspective-correct barycentric weights of a triangle at a pixel. The ray and
// camera_from_world are those of one view.
Eigen::Vector3f weights_in_triangle(const output::TriangleMesh& mesh, std::uint32_t triangle,
                                    const Rigid3& camera_from_world,
                                    const Eigen::Vector3d& ray_in_camera);

}  // namespace hermite::texture
