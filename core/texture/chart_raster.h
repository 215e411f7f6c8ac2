// A chart projected onto a raster of texels. Pure functions.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/output/triangle_mesh.h"
#include "core/texture/chart_growth.h"

namespace hermite::texture {

// Width of the gutter of a chart: texels around it that repeat its colours, so that its first two
// mipmaps do not mix with another chart.
inline constexpr int kGutter_texels = 4;

// Texel (x, y) has its centre at (x + 0.5, y + 0.5).
struct FlatChart {
  std::vector<std::uint32_t> triangles;
  // Rows: directions in the chart's plane / texel size.
  Eigen::Matrix<float, 2, 3> texels_from_world = Eigen::Matrix<float, 2, 3>::Zero();
  Eigen::Vector2f offset = Eigen::Vector2f::Zero();  // texels
  float texel_m = 0;
  int width = 0, height = 0;  // texels, including the gutter

  Eigen::Vector2f at(const Eigen::Vector3f& point) const {
    return texels_from_world * point + offset;
  }
};

// Projects along the chart's normal, rotated so that the chart has the smallest bounding rectangle.
// Texels have the size `texel_m`, or more if the chart would exceed `max_side_texels` in width or
// height including the gutter.
FlatChart flattened(const output::TriangleMesh& mesh, const Chart& chart, double texel_m,
                    int max_side_texels);

// Distance from a triangle up to which texels take its colour.
inline constexpr float kReach_texels = 1.6f;
// Stands for the triangle of a texel without colour.
inline constexpr std::uint32_t kNoTexel = 0xffffffff;

// By texel, the triangle from which it takes its colour: the one that contains its centre, or else
// the nearest within kReach_texels, so that bilinear sampling on the chart never reaches a texel
// without colour; otherwise kNoTexel.
struct ChartRaster {
  Image<std::uint32_t> triangle;
  // Triangles that overlap earlier ones of the chart, or face backwards.
  std::vector<std::uint32_t> overlapping;
};
ChartRaster raster_of(const output::TriangleMesh& mesh, const FlatChart& chart);

// The point of a triangle at the centre of a texel. Outside the triangle it is extrapolated in the
// plane of the chart.
struct ChartPoint {
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit; interpolated from the vertex normals
  Eigen::Vector3f color = Eigen::Vector3f::Zero();   // 0 to 255, interpolated from the vertices
};
ChartPoint point_at(const output::TriangleMesh& mesh, const FlatChart& chart,
                    std::uint32_t triangle, int x, int y);

}  // namespace hermite::texture
