// The surface within a cube of kCubeCells^3 cells, by dual contouring of the field. Cubes can be contoured in any order and alone: what two
// neighbours need of each other both compute, to the same bits.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "core/base/image.h"
#include "core/mesh/surfel_field.h"

namespace hermite {

inline constexpr int kCubeCells = 32;

// Cell and piece of surface that a vertex is of; ordered by z, y, x, piece.
using VertexKey = std::uint64_t;
VertexKey vertex_key(const Eigen::Vector3i& cell, int piece);
Eigen::Vector3i cell_of(VertexKey key);

Eigen::Vector3i cube_of(const Eigen::Vector3i& cell);  // that the cell is of

struct CubeVertex {
  VertexKey key = 0;
  Eigen::Vector3f position_m = Eigen::Vector3f::Zero();
  Eigen::Vector3f normal = Eigen::Vector3f::Zero();  // unit
  Rgb8 color;
  bool is_supported = true;  // false: no surfel is near, and there should be no surface
  bool is_smooth = true;     // false: on an edge or corner, where the normal is a mean
};

// Counter-clockwise seen from outside.
using CubeQuad = std::array<VertexKey, 4>;

struct CubeSurface {
  std::vector<CubeVertex> vertices;  // of the cube's own cells, in the order of their keys
  std::vector<CubeQuad> quads;       // of edges that begin in the cube's own cells; vertices of cells below them may be another cube's
};

// `cube` spans the cells from kCubeCells * cube on. Thread-safe.
CubeSurface contour_cube(const SurfelField& field, const Eigen::Vector3i& cube);

// The same with the vertices of the cells next below, as the cubes there have them: all that its quads need.
CubeSurface contour_whole_cube(const SurfelField& field, const Eigen::Vector3i& cube);

// The cells around a cube that its surface depends on.
inline constexpr int kCubeMargin = 2;

}  // namespace hermite
