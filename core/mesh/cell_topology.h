// Which edge crossings of a grid cell belong to the same piece of surface. Dual contouring places
// one vertex per piece, so that two sheets in one cell stay separate (Nielson 2004, Dual marching
// cubes; Schaefer, Ju, Warren 2007, Manifold dual contouring). Pure functions.
//
// Corner i of a cell lies at (i & 1, i >> 1 & 1, i >> 2 & 1). Edge 4 a + b + 2 c runs along axis a
// from the corner with offset b along axis (a + 1) % 3 and c along (a + 2) % 3. Face 2 a + s is
// across axis a, at its lower (0) or upper (1) end.
#pragma once

#include <array>
#include <cstdint>

namespace hermite::mesh {

inline constexpr int kCellCorners = 8, kCellEdges = 12, kCellFaces = 6;

int lower_corner_of_edge(int edge);
inline int upper_corner_of_edge(int edge) { return lower_corner_of_edge(edge) | 1 << (edge / 4); }

struct CellPieces {
  std::array<std::int8_t, kCellEdges> piece_of_edge{};  // -1: the edge is not crossed
  int count = 0;
};

// Returns the pieces of a cell. `inside` has one bit per corner, set behind the surface. `crossed`
// has a bit for each edge with a crossing, a subset of those whose ends differ (CHECK). On an
// ambiguous face, the corners inside are kept apart; on the faces of `joined` (a bit for each
// face), the corners outside are.
CellPieces pieces_of_cell(std::uint8_t inside, std::uint16_t crossed, std::uint8_t joined);

// Returns whether the signs of the face's corners alternate, so that all four of its edges are
// crossed (an ambiguous face).
bool is_ambiguous(std::uint8_t inside, std::uint16_t crossed, int face);

// Returns whether all four crossings of the face are in one piece. If they are in both cells of the
// face, four quads would share an edge, so the face must be joined.
bool face_is_one_piece(const CellPieces& pieces, int face);

}  // namespace hermite::mesh
