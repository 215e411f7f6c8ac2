// A surface of triangles, for files and viewers. Plain values, in metres, in the world of the scan (the first camera: x right, y down,
// z forward).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/image.h"

namespace hermite {

using TriangleCorners = std::array<std::uint32_t, 3>;  // into the vertices; counter-clockwise seen from outside

// An image that a run of triangles takes its colour from.
struct TexturePage {
  ColorImage image;
  std::uint32_t first_triangle = 0, triangle_count = 0;
};

// Arrays by vertex are of one length. A vertex where the surface has an edge has one normal, a mean; a vertex on the border of two charts
// of the texture exists once for each.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> positions_m;
  std::vector<Eigen::Vector3f> normals;  // unit, out of the surface, to where it was seen from
  std::vector<Rgb8> colors;
  std::vector<TriangleCorners> triangles;
  // By triangle, 1: nobody has seen it, it was made up across a hole. Empty: there is none.
  std::vector<std::uint8_t> is_filled;

  // With a texture only: by vertex, (0, 0) is the upper left corner of the image and (1, 1) the lower right one; pages in the order of
  // their triangles, all triangles in one of them. Without: both empty.
  std::vector<Eigen::Vector2f> texture_coordinates;
  std::vector<TexturePage> pages;
};

}  // namespace hermite
