// A chart laid flat on a raster of texels. Pure functions.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/chart_growth.h"

namespace hermite {

// Texels around a chart that belong to it: a viewer that takes the mean of two by two texels, or of four by four, sees no other chart.
inline constexpr int kGutter_texels = 4;

// Texel (x, y) has its centre at (x + 0.5, y + 0.5).
struct FlatChart {
  std::vector<std::uint32_t> triangles;
  Eigen::Matrix<float, 2, 3> texels_from_world = Eigen::Matrix<float, 2, 3>::Zero();  // rows: directions in the chart's plane / texel size
  Eigen::Vector2f offset = Eigen::Vector2f::Zero();                                   // texels
  float texel_m = 0;
  int width = 0, height = 0;  // texels, the gutter included

  Eigen::Vector2f at(const Eigen::Vector3f& point) const { return texels_from_world * point + offset; }
};

// Looks along the chart's normal, turned so that the chart fills the smallest rectangle. Texels are of `texel_m`, larger where the chart
// would be wider or higher than `max_side_texels`, gutter included.
FlatChart flattened(const TriangleMesh& mesh, const Chart& chart, double texel_m, int max_side_texels);

// By texel the triangle whose colour it has: the one its centre is in, or the nearest within kReach_texels, so that a mean of four texels
// anywhere on the chart is one of this chart's; else kNoTexel.
inline constexpr float kReach_texels = 1.6f;
inline constexpr std::uint32_t kNoTexel = 0xffffffff;
struct ChartRaster {
  Image<std::uint32_t> triangle;
  std::vector<std::uint32_t> overlapping;  // triangles that lie on earlier ones of the chart, or are seen from behind
};
ChartRaster raster_of(const TriangleMesh& mesh, const FlatChart& chart);

// What the texel shows of that triangle. Beside the triangle the place goes on from its border within the plane of the chart.
struct SurfacePoint {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit; of the mesh's normals, which are smooth
  Eigen::Vector3f color = Eigen::Vector3f::Zero();   // 0 to 255, of the vertices
};
SurfacePoint point_at(const TriangleMesh& mesh, const FlatChart& chart, std::uint32_t triangle, int x, int y);

}  // namespace hermite
