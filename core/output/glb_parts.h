// A mesh cut into what glTF calls primitives: one for each page of the texture and one more for what is filled of it, with vertices of
// their own. Values in glTF's axes and units. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite {

using LinearRgba16 = std::array<std::uint16_t, 4>;

// What an sRGB colour is in glTF, where colours of vertices are linear: 16 bits, since 8 would leave a dark colour two or three steps.
LinearRgba16 linear_color(Rgb8 color);

struct GlbPart {
  std::vector<Eigen::Vector3f> positions, normals;   // metres, y up; unit
  std::vector<LinearRgba16> colors;                  // without a texture only
  std::vector<Eigen::Vector2f> texture_coordinates;  // with one only
  std::vector<TriangleCorners> triangles;            // at least one
  std::size_t page = 0;
  bool is_filled = false;
};

// In the order of the pages, of each what was seen before what is filled, those without a triangle left out; vertices in the order of their
// first triangle. `mesh` was checked (mesh_check.h) and has a triangle.
std::vector<GlbPart> glb_parts(const TriangleMesh& mesh);

// glTF takes unit normals only; one without a length looks up.
Eigen::Vector3f unit_normal_y_up(const Eigen::Vector3f& normal);

}  // namespace hermite
