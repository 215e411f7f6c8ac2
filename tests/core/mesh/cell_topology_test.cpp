#include "core/mesh/cell_topology.h"

#include <gtest/gtest.h>

#include <set>

namespace hermite::mesh {
namespace {

std::uint16_t all_crossings(std::uint8_t inside) {
  unsigned crossed = 0;
  for (int edge = 0; edge < kCellEdges; ++edge)
    if ((inside >> lower_corner_of_edge(edge) & 1) != (inside >> upper_corner_of_edge(edge) & 1))
      crossed |= 1u << edge;
  return static_cast<std::uint16_t>(crossed);
}

TEST(CellTopology, EdgesJoinCornersThatAreNeighbors) {
  std::set<std::pair<int, int>> edges;
  for (int edge = 0; edge < kCellEdges; ++edge) {
    const int difference = lower_corner_of_edge(edge) ^ upper_corner_of_edge(edge);
    EXPECT_EQ(difference, 1 << edge / 4);
    edges.emplace(lower_corner_of_edge(edge), upper_corner_of_edge(edge));
  }
  EXPECT_EQ(edges.size(), 12u);
}

TEST(CellTopology, ACornerIsCutOffByOnePieceOfThreeCrossings) {
  for (int corner = 0; corner < kCellCorners; ++corner) {
    const auto inside = static_cast<std::uint8_t>(1u << corner);
    const CellPieces pieces = pieces_of_cell(inside, all_crossings(inside), 0);
    EXPECT_EQ(pieces.count, 1);
    int crossings = 0;
    for (const std::int8_t piece : pieces.piece_of_edge) crossings += piece == 0 ? 1 : 0;
    EXPECT_EQ(crossings, 3);
  }
}

TEST(CellTopology, OppositeCornersAreTwoPieces) {
  const std::uint8_t inside = 1u << 0 | 1u << 7;
  EXPECT_EQ(pieces_of_cell(inside, all_crossings(inside), 0).count, 2);
}

// Corners 0 and 3 lie across the lower face of z.
TEST(CellTopology, AFaceWhoseCornersAlternateIsJoinedOnRequest) {
  const std::uint8_t inside = 1u << 0 | 1u << 3;
  const int face = 4;
  ASSERT_TRUE(is_ambiguous(inside, all_crossings(inside), face));
  EXPECT_EQ(pieces_of_cell(inside, all_crossings(inside), 0).count, 2);
  const CellPieces joined = pieces_of_cell(inside, all_crossings(inside), 1u << face);
  EXPECT_EQ(joined.count, 1);
  EXPECT_TRUE(face_is_one_piece(joined, face));
}

// Every sign pattern, however its faces are read: each crossing is in a piece, and a piece leaves
// each face as often as it comes to it.
TEST(CellTopology, PiecesAreClosedOnTheFacesOfEveryCell) {
  for (unsigned inside = 0; inside < 256; ++inside)
    for (unsigned joined = 0; joined < 64; ++joined) {
      const auto bits = static_cast<std::uint8_t>(inside);
      const CellPieces pieces =
          pieces_of_cell(bits, all_crossings(bits), static_cast<std::uint8_t>(joined));
      for (int edge = 0; edge < kCellEdges; ++edge)
        ASSERT_EQ(pieces.piece_of_edge[static_cast<std::size_t>(edge)] >= 0,
                  (all_crossings(bits) >> edge & 1) != 0);
      for (int piece = 0; piece < pieces.count; ++piece) {
        int crossings = 0;
        for (const std::int8_t of : pieces.piece_of_edge) crossings += of == piece ? 1 : 0;
        ASSERT_GE(crossings, 3) << inside << ' ' << joined;
      }
    }
}

TEST(CellTopology, WhatIsNotCrossedIsInNoPiece) {
  const std::uint8_t inside = 1;
  const auto crossed = static_cast<std::uint16_t>(all_crossings(inside) & ~1u);  // without edge 0
  const CellPieces pieces = pieces_of_cell(inside, crossed, 0);
  EXPECT_EQ(pieces.piece_of_edge[0], -1);
  EXPECT_EQ(pieces.count, 1) << "the two others share a face";
  EXPECT_EQ(pieces_of_cell(inside, 0, 0).count, 0);
}

TEST(CellTopologyDeathTest, ACrossingBetweenCornersOfOneSideIsAMistake) {
  EXPECT_DEATH((void)pieces_of_cell(0, 1, 0), "one side");
}

}  // namespace
}  // namespace hermite::mesh
