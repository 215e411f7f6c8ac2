// Splits a mesh into glTF primitives with their own vertices: for each texture page one of observed
// and one of filled triangles. Values are in glTF's axes and units. Pure.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/output/triangle_mesh.h"

namespace hermite::output {

using LinearRgba16 = std::array<std::uint16_t, 4>;

// Converts an sRGB colour to linear, as glTF has vertex colours. It has 16 bits, because 8 would
// leave only two or three steps for dark colours.
LinearRgba16 linear_color(Rgb8 color);

struct GlbPart {
  std::vector<Eigen::Vector3f> positions, normals;   // positions in metres with y up; unit normals
  std::vector<LinearRgba16> colors;                  // only without a texture
  std::vector<Eigen::Vector2f> texture_coordinates;  // only with a texture
  std::vector<TriangleCorners> triangles;            // at least one
  std::size_t page = 0;
  bool is_filled = false;
};

// Returns the parts that have triangles, in the order of pages, observed before filled; vertices in
// the order of their first triangle. `mesh` must have been checked (mesh_check.h) and have a
// triangle.
std::vector<GlbPart> glb_parts(const TriangleMesh& mesh);

// Returns a unit normal, as glTF requires; a normal of length zero becomes (0, 1, 0).
Eigen::Vector3f unit_normal_y_up(const Eigen::Vector3f& normal);

}  // namespace hermite::output
