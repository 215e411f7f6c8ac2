// Which crossings of a cell's edges belong to one piece of surface: dual contouring puts a vertex into each piece, so that two sheets that
// pass one cell do not meet in it (Nielson 2004, Dual marching cubes; Schaefer, Ju, Warren 2007, Manifold dual contouring). Pure functions.
//
// Corner i of a cell lies at (i & 1, i >> 1 & 1, i >> 2 & 1). Edge 4 a + b + 2 c runs along axis a from the corner with offset b along axis
// (a + 1) % 3 and c along (a + 2) % 3. Face 2 a + s is across axis a, at its lower (0) or upper (1) end.
#pragma once

#include <array>
#include <cstdint>

namespace hermite {

inline constexpr int kCellCorners = 8, kCellEdges = 12, kCellFaces = 6;

int lower_corner_of_edge(int edge);
inline int upper_corner_of_edge(int edge) { return lower_corner_of_edge(edge) | 1 << (edge / 4); }

struct CellPieces {
  std::array<std::int8_t, kCellEdges> piece_of_edge{};  // -1: the edge is not crossed
  int count = 0;
};

// `inside`: a bit for each corner behind the surface. `crossed`: a bit for each edge with a crossing, a subset of those whose ends differ
// (CHECK). On a face whose corners alternate, corners inside are kept apart, on those of `joined` (a bit for each face) the others.
CellPieces pieces_of_cell(std::uint8_t inside, std::uint16_t crossed, std::uint8_t joined);

// Is that face one whose corners alternate, with all four edges crossed?
bool is_ambiguous(std::uint8_t inside, std::uint16_t crossed, int face);

// All crossings of the face in one piece? When the cells on both sides say so, four quads would share an edge: the face must be joined.
bool face_is_one_piece(const CellPieces& pieces, int face);

}  // namespace hermite
