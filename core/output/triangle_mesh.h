// A triangle mesh. Plain values in metres, in the world frame of the scan (the first camera: x
// right, y down, z forward).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/image.h"

namespace hermite::output {

// Vertex indices, counter-clockwise seen from outside.
using TriangleCorners = std::array<std::uint32_t, 3>;

// An image that textures a range of triangles.
struct TexturePage {
  ColorImage image;
  std::uint32_t first_triangle = 0, triangle_count = 0;
};

// Per-vertex arrays have equal length. A vertex on an edge of the surface has one normal, a mean; a
// vertex on the border of two texture charts exists once per chart.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> positions_m;
  std::vector<Eigen::Vector3f> normals;  // unit length, out of the surface towards the observer
  std::vector<Rgb8> colors;
  // Only of a piece of a live surface, otherwise empty: how well the surfels around the vertex were
  // seen (eighths_of_confidence).
  std::vector<std::uint8_t> confidence_eighths;
  std::vector<TriangleCorners> triangles;
  // Per triangle, 1 if it fills a hole and was not observed. Empty if there are none.
  std::vector<std::uint8_t> is_filled;

  // Only with a texture: coordinates per vertex, where (0, 0) is the upper left corner of the image
  // and (1, 1) the lower right one, and pages in the order of their triangles, which together cover
  // all triangles. Both are empty otherwise.
  std::vector<Eigen::Vector2f> texture_coordinates;
  std::vector<TexturePage> pages;
};

}  // namespace hermite::output
