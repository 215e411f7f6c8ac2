#include "core/mesh/cell_topology.h"

#include <numeric>

#include "core/base/check.h"

namespace hermite::mesh {
namespace {

// The corners of a face in cyclic order, and the edges from each to the next.
struct Face {
  std::array<int, 4> corners{}, edges{};
};

constexpr int edge_of(int axis, int b, int c) { return 4 * axis + b + 2 * c; }

Face face_of(int face) {
  const int a = face / 2, b = (a + 1) % 3, c = (a + 2) % 3, side = face % 2;
  const auto corner = [&](int at_b, int at_c) { return side << a | at_b << b | at_c << c; };
  // An edge along b has c and a as its other axes, in this order; one along c has a and b.
  return {{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)},
          {edge_of(b, 0, side), edge_of(c, side, 1), edge_of(b, 1, side), edge_of(c, side, 0)}};
}

const std::array<Face, kCellFaces>& faces() {
  static const std::array<Face, kCellFaces> all = [] {
    std::array<Face, kCellFaces> made;
    for (int face = 0; face < kCellFaces; ++face)
      made[static_cast<std::size_t>(face)] = face_of(face);
    return made;
  }();
  return all;
}

bool has(unsigned bits, int index) { return (bits >> index & 1u) != 0; }

bool corners_alternate(std::uint8_t inside, const Face& face) {
  const auto at = [&](std::size_t i) { return has(inside, face.corners[i]); };
  return at(0) == at(2) && at(1) == at(3) && at(0) != at(1);
}

// Union-find over the twelve edges.
class Pieces {
 public:
  Pieces() { std::iota(root_.begin(), root_.end(), 0); }
  int root(int edge) const {
    while (root_[static_cast<std::size_t>(edge)] != edge)
      edge = root_[static_cast<std::size_t>(edge)];
    return edge;
  }
  void join(int a, int b) {
    root_[static_cast<std::size_t>(std::max(root(a), root(b)))] = std::min(root(a), root(b));
  }

 private:
  std::array<int, kCellEdges> root_{};
};

void join_on_face(const Face& face, std::uint8_t inside, std::uint16_t crossed, bool joined,
                  Pieces& pieces) {
  const auto join = [&](std::size_t i, std::size_t j) {
    if (has(crossed, face.edges[i]) && has(crossed, face.edges[j]))
      pieces.join(face.edges[i], face.edges[j]);
  };
  if (corners_alternate(inside, face)) {
    // Corner i lies between edges i - 1 and i.
    const std::size_t first = has(inside, face.corners[0]) == joined ? 1 : 0;
    for (const std::size_t corner : {first, first + 2}) join((corner + 3) % 4, corner);
    return;
  }
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) join(i, j);
}

}  // namespace

int lower_corner_of_edge(int edge) {
  const int a = edge / 4;
  return (edge & 1) << (a + 1) % 3 | (edge >> 1 & 1) << (a + 2) % 3;
}

CellPieces pieces_of_cell(std::uint8_t inside, std::uint16_t crossed, std::uint8_t joined) {
  Pieces pieces;
  for (int face = 0; face < kCellFaces; ++face)
    join_on_face(faces()[static_cast<std::size_t>(face)], inside, crossed, has(joined, face),
                 pieces);
  CellPieces result;
  std::array<std::int8_t, kCellEdges> number{};
  for (int edge = 0; edge < kCellEdges; ++edge) {
    const auto i = static_cast<std::size_t>(edge);
    result.piece_of_edge[i] = -1;
    if (!has(crossed, edge)) continue;
    CHECK(has(inside, lower_corner_of_edge(edge)) != has(inside, upper_corner_of_edge(edge)),
          "an edge with both ends on one side is crossed");
    const auto root = static_cast<std::size_t>(pieces.root(edge));
    if (root == i) number[i] = static_cast<std::int8_t>(result.count++);
    result.piece_of_edge[i] = number[root];
  }
  return result;
}

bool is_ambiguous(std::uint8_t inside, std::uint16_t crossed, int face) {
  const Face& of = faces()[static_cast<std::size_t>(face)];
  for (const int edge : of.edges)
    if (!has(crossed, edge)) return false;
  return corners_alternate(inside, of);
}

bool face_is_one_piece(const CellPieces& pieces, int face) {
  const Face& of = faces()[static_cast<std::size_t>(face)];
  for (const int edge : of.edges)
    if (pieces.piece_of_edge[static_cast<std::size_t>(edge)] !=
        pieces.piece_of_edge[static_cast<std::size_t>(of.edges[0])])
      return false;
  return true;
}

}  // namespace hermite::mesh
