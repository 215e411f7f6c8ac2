// The surface within a cube of kCubeCells^3 cells, by dual contouring of the field. Cubes can be
// contoured independently and in any order: where two cubes adjoin, both compute the vertices that
// they share, to the same bits.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/mesh/surfel_field.h"

namespace hermite::mesh {

inline constexpr int kCubeCells = 32;

// The cell of a vertex and the piece of surface within it; ordered by z, y, x, piece.
using VertexKey = std::uint64_t;
VertexKey vertex_key(const Eigen::Vector3i& cell, int piece);
Eigen::Vector3i cell_of(VertexKey key);

Eigen::Vector3i cube_of(const Eigen::Vector3i& cell);  // the cube that contains the cell

struct CubeVertex {
  VertexKey key = 0;
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit
  Rgb8 color;
  std::uint8_t confidence_eighths = 0;  // mean over the surfels that the colour is of
  bool is_supported = true;             // false: no surfel is near enough to support a surface here
  // False: on a sharp edge or corner, where the normal is a mean of several.
  bool is_smooth = true;
};

// Counter-clockwise seen from outside.
using CubeQuad = std::array<VertexKey, 4>;

struct CubeSurface {
  std::vector<CubeVertex> vertices;  // of the cells of the cube, ordered by key
  // Quads of edges that start in the cells of the cube; their vertices may lie in the adjacent
  // lower cubes.
  std::vector<CubeQuad> quads;
};

// Contours the cells from kCubeCells * cube up to, not including, kCubeCells * (cube + 1).
// Thread-safe.
CubeSurface contour_cube(const SurfelField& field, const Eigen::Vector3i& cube);

// As contour_cube(). Also returns the vertices of the adjacent lower cells, so that all vertices of
// its quads are included.
CubeSurface contour_whole_cube(const SurfelField& field, const Eigen::Vector3i& cube);

// Width of the margin of cells around a cube on which its surface depends.
inline constexpr int kCubeMargin = 2;

}  // namespace hermite::mesh
