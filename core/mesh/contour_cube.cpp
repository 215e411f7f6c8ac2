#include "core/mesh/contour_cube.h"

#include <algorithm>
#include <cmath>

#include "core/mesh/cell_topology.h"
#include "core/mesh/edge_vertex.h"

namespace hermite::mesh {
namespace {

// Quads need the pieces of the adjacent lower cells, and these need the crossings of the cells
// around them.
constexpr int kMargin = kCubeMargin;
constexpr int kSide = kCubeCells + 2 * kMargin;  // corners along an axis: those of cells -2 to 32
constexpr std::size_t kCorners = std::size_t{kSide} * kSide * kSide;

// With less coverage than this the surface is extrapolated and left out: coverage is one half on
// the border of a sheet and one quarter at its corner. Half a cell beyond the outermost surfels,
// the lean of the kernels is a quarter of their support, so the mesh is as wide as the cloud.
constexpr float kLeastCoverage = 0.2f, kMostLean = 0.25f;
constexpr int kLeastKernels = 4;
// A surface two cells or more from all surfels is extrapolated as well, unless the surfels are that
// far apart: a support is three times their distance. The limit is slightly below two, since folds
// are flattened afterwards.
constexpr float kFarthest_cells = 1.9f, kFarthest_supports = 0.45f;
// Vertices keep this distance from the faces of their cell, so that no two of them coincide.
constexpr float kInset_cells = 0.01f;
// Newton steps along an edge towards the surface; two are nearly sufficient.
constexpr int kSteps = 3;
constexpr float kLeastSlope = 0.1f;
// Below this length of the mean normal (a few degrees of spread) the field of a corner is evaluated
// robustly.
constexpr float kOneSheet = 0.97f;
// Plain sums are off by 0.07 radius^2 x mean curvature (core/math/hrbf.h): a quarter of a cell for
// a ball of 10 cm in cells of 1 cm.
constexpr float kBias_cells = 0.25f;

// The field at the corners of the grid, as plain weighted sums.
struct CornerSums {
  float weights = 0, distances_m = 0;
  Eigen::Vector3f normals = Eigen::Vector3f::Zero();
};

enum class Side : std::uint8_t { kUnknown, kOutside, kInside };

struct Crossing {
  SurfacePlane plane;
  Rgb8 color;
  std::uint8_t confidence_eighths = 0;
};

std::uint8_t byte_of(float value) {
  return static_cast<std::uint8_t>(std::clamp(value + 0.5f, 0.0f, 255.0f));
}

class CubeContour {
 public:
  CubeContour(const SurfelField& field, const Eigen::Vector3i& cube)
      : field_(field),
        first_cell_(cube * kCubeCells - Eigen::Vector3i::Constant(kMargin)),
        window_(field, first_cell_, first_cell_ + Eigen::Vector3i::Constant(kSide)) {}

  // Also includes the vertices of this many layers of cells below the cube.
  CubeSurface contour(int cells_below) {
    if (window_.empty()) return {};
    add_kernels();
    decide_sides();
    find_crossings();
    if (crossings_.empty()) return {};
    find_pieces();
    CubeSurface surface;
    make_vertices(cells_below, surface);
    make_quads(surface);
    return surface;
  }

 private:
  static std::size_t at(int x, int y, int z) {
    return (static_cast<std::size_t>(z) * kSide + static_cast<std::size_t>(y)) * kSide +
           static_cast<std::size_t>(x);
  }
  static std::size_t at(const Eigen::Vector3i& corner) {
    return at(corner.x(), corner.y(), corner.z());
  }
  Eigen::Vector3f position_m(const Eigen::Vector3i& corner) const {
    return ((first_cell_ + corner).cast<double>() * field_.cell_m()).cast<float>();
  }

  void add_kernels();
  void add_kernel(const FieldKernel& kernel);
  void decide_sides();
  void find_crossings();
  void find_crossing(const Eigen::Vector3i& corner, int axis);
  std::uint8_t inside_bits(const Eigen::Vector3i& cell) const;
  void mark_crossed(const Eigen::Vector3i& corner, int axis);
  int crossing_of(const Eigen::Vector3i& cell, int edge) const;
  void find_pieces();
  void join_faces(const Eigen::Vector3i& cell);
  void make_vertices(int cells_below, CubeSurface& surface);
  CubeVertex make_vertex(const Eigen::Vector3i& cell, int piece);
  void make_quads(CubeSurface& surface) const;
  void make_quad(const Eigen::Vector3i& corner, int axis, CubeSurface& surface) const;

  template <class Use>
  static void for_each(int first, int last, const Use& use) {
    for (int z = first; z < last; ++z)
      for (int y = first; y < last; ++y)
        for (int x = first; x < last; ++x) use(Eigen::Vector3i(x, y, z));
  }

  const SurfelField& field_;
  const Eigen::Vector3i first_cell_;
  FieldWindow window_;
  std::vector<CornerSums> sums_;
  std::vector<float> values_m_;
  std::vector<Side> sides_;
  std::vector<Crossing> crossings_;
  std::vector<std::array<std::int32_t, 3>> crossing_by_edge_;  // by corner and axis; -1: none
  struct Cell {
    std::uint16_t crossed = 0;  // 0: the other members are not set
    std::uint8_t inside = 0, joined = 0;
    CellPieces pieces;
  };
  std::vector<Cell> cells_;  // by their lower corner
};

void CubeContour::add_kernels() {
  sums_.assign(kCorners, {});
  window_.for_each_kernel([this](const FieldKernel& kernel) { add_kernel(kernel); });
}

// Adds a kernel to all corners within its support.
void CubeContour::add_kernel(const FieldKernel& kernel) {
  const auto cell_m = static_cast<float>(field_.cell_m());
  const Eigen::Vector3f middle =
      (kernel.position_m.cast<double>() / field_.cell_m() - first_cell_.cast<double>())
          .cast<float>();
  const Eigen::Vector3f reach = Eigen::Vector3f::Constant(kernel.radius_m / cell_m);
  const Eigen::Vector3i first = (middle - reach).array().ceil().cast<int>().max(0);
  const Eigen::Vector3i last = (middle + reach).array().floor().cast<int>().min(kSide - 1);
  const float radius2 = kernel.radius_m * kernel.radius_m;
  for (int z = first.z(); z <= last.z(); ++z)
    for (int y = first.y(); y <= last.y(); ++y)
      for (int x = first.x(); x <= last.x(); ++x) {
        const Eigen::Vector3f from_kernel_m = position_m({x, y, z}) - kernel.position_m;
        const float distance2 = from_kernel_m.squaredNorm();
        if (!(distance2 < radius2)) continue;
        const float s = 1 - std::sqrt(distance2) / kernel.radius_m,
                    weight = kernel.weight * s * s * s;
        CornerSums& sums = sums_[at(x, y, z)];
        sums.weights += weight;
        sums.distances_m += weight * kernel.normal.dot(from_kernel_m);
        sums.normals += weight * kernel.normal;
      }
}

void CubeContour::decide_sides() {
  values_m_.assign(kCorners, 0);
  sides_.assign(kCorners, Side::kUnknown);
  const auto cell_m = static_cast<float>(field_.cell_m());
  const float near_m = 2 * cell_m, close_m = kBias_cells * cell_m;
  for_each(0, kSide, [&](const Eigen::Vector3i& corner) {
    const CornerSums& sums = sums_[at(corner)];
    if (!(sums.weights > 0)) return;
    float value_m = sums.distances_m / sums.weights;
    const bool is_doubtful =
        std::abs(value_m) < close_m ||
        (std::abs(value_m) < near_m && sums.normals.norm() < kOneSheet * sums.weights);
    if (is_doubtful) value_m = window_.sample(position_m(corner)).value_m;
    values_m_[at(corner)] = value_m;
    sides_[at(corner)] = value_m < 0 ? Side::kInside : Side::kOutside;
  });
}

void CubeContour::find_crossings() {
  crossing_by_edge_.assign(kCorners, {-1, -1, -1});
  for_each(0, kSide, [&](const Eigen::Vector3i& corner) {
    if (sides_[at(corner)] == Side::kUnknown) return;
    for (int axis = 0; axis < 3; ++axis) {
      if (corner[axis] + 1 >= kSide) continue;
      const Side other = sides_[at(corner + Eigen::Vector3i::Unit(axis))];
      if (other != Side::kUnknown && other != sides_[at(corner)]) find_crossing(corner, axis);
    }
  });
}

void CubeContour::find_crossing(const Eigen::Vector3i& corner, int axis) {
  const Eigen::Vector3i other = corner + Eigen::Vector3i::Unit(axis);
  const Eigen::Vector3f begin_m = position_m(corner), along_m = position_m(other) - begin_m;
  const float value_m = values_m_[at(corner)];
  float t = value_m / (value_m - values_m_[at(other)]);
  const float length_m = along_m.norm();
  FieldSample sample;
  Eigen::Vector3f point_m;
  for (int step = 0; step < kSteps; ++step) {
    point_m = begin_m + t * along_m;
    sample = window_.sample(point_m);
    if (sample.kernel_count < kLeastKernels) return;
    const float slope = sample.normal[axis];
    if (std::abs(slope) < kLeastSlope) break;
    t = std::clamp(t - sample.value_m / (slope * length_m), 0.0f, 1.0f);
  }
  // From inside to outside, an edge passes through the surface towards the side from which it was
  // seen.
  const bool is_outwards = sides_[at(corner)] == Side::kInside;
  const bool agrees = is_outwards ? sample.normal[axis] > -0.3f : sample.normal[axis] < 0.3f;
  if (sample.coverage < kLeastCoverage || sample.lean > kMostLean || !agrees ||
      std::abs(sample.value_m) > length_m)
    return;
  crossing_by_edge_[at(corner)][static_cast<std::size_t>(axis)] =
      static_cast<std::int32_t>(crossings_.size());
  crossings_.push_back(
      {{point_m - sample.value_m * sample.normal, sample.normal},
       {byte_of(sample.color.x()), byte_of(sample.color.y()), byte_of(sample.color.z())},
       byte_of(sample.confidence_eighths)});
}

std::uint8_t CubeContour::inside_bits(const Eigen::Vector3i& cell) const {
  unsigned bits = 0;
  for (int corner = 0; corner < kCellCorners; ++corner)
    if (sides_[at(cell + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2))] ==
        Side::kInside)
      bits |= 1u << corner;
  return static_cast<std::uint8_t>(bits);
}

int CubeContour::crossing_of(const Eigen::Vector3i& cell, int edge) const {
  const int corner = lower_corner_of_edge(edge);
  return crossing_by_edge_[at(cell + Eigen::Vector3i(corner & 1, corner >> 1 & 1, corner >> 2))]
                          [static_cast<std::size_t>(edge / 4)];
}

// Marks the crossing in the four cells around the edge.
void CubeContour::mark_crossed(const Eigen::Vector3i& corner, int axis) {
  const int at_b = (axis + 1) % 3, at_c = (axis + 2) % 3;
  for (int around = 0; around < 4; ++around) {
    const int b = around & 1, c = around >> 1;
    if (corner[at_b] < b || corner[at_c] < c) continue;
    Cell& cell =
        cells_[at(corner - b * Eigen::Vector3i::Unit(at_b) - c * Eigen::Vector3i::Unit(at_c))];
    cell.crossed = static_cast<std::uint16_t>(cell.crossed | 1u << (4 * axis + b + 2 * c));
  }
}

void CubeContour::find_pieces() {
  cells_.assign(kCorners, {});
  for_each(0, kSide, [this](const Eigen::Vector3i& corner) {
    for (int axis = 0; axis < 3; ++axis)
      if (crossing_by_edge_[at(corner)][static_cast<std::size_t>(axis)] >= 0)
        mark_crossed(corner, axis);
  });
  for_each(0, kSide - 1, [this](const Eigen::Vector3i& corner) {
    Cell& cell = cells_[at(corner)];
    if (cell.crossed == 0) return;
    cell.inside = inside_bits(corner);
    cell.pieces = pieces_of_cell(cell.inside, cell.crossed, 0);
  });
  for_each(1, kSide - 2, [this](const Eigen::Vector3i& corner) {
    if (cells_[at(corner)].crossed != 0) join_faces(corner);
  });
  for_each(1, kSide - 2, [this](const Eigen::Vector3i& corner) {
    Cell& cell = cells_[at(corner)];
    if (cell.joined != 0) cell.pieces = pieces_of_cell(cell.inside, cell.crossed, cell.joined);
  });
}

void CubeContour::join_faces(const Eigen::Vector3i& cell) {
  Cell& here = cells_[at(cell)];
  for (int face = 0; face < kCellFaces; ++face) {
    if (!is_ambiguous(here.inside, here.crossed, face) || !face_is_one_piece(here.pieces, face))
      continue;
    const Eigen::Vector3i step = Eigen::Vector3i::Unit(face / 2);
    const Eigen::Vector3i neighbor =
        face % 2 == 1 ? Eigen::Vector3i(cell + step) : Eigen::Vector3i(cell - step);
    if (face_is_one_piece(cells_[at(neighbor)].pieces, face ^ 1))
      here.joined = static_cast<std::uint8_t>(here.joined | 1u << face);
  }
}

void CubeContour::make_vertices(int cells_below, CubeSurface& surface) {
  for_each(kMargin - cells_below, kMargin + kCubeCells, [&](const Eigen::Vector3i& cell) {
    const Cell& here = cells_[at(cell)];
    if (here.crossed == 0) return;
    for (int piece = 0; piece < here.pieces.count; ++piece)
      surface.vertices.push_back(make_vertex(cell, piece));
  });
}

CubeVertex CubeContour::make_vertex(const Eigen::Vector3i& cell, int piece) {
  std::vector<SurfacePlane> planes;
  Eigen::Vector3f normals = Eigen::Vector3f::Zero(), colors = Eigen::Vector3f::Zero();
  float confidence_eighths = 0;
  for (int edge = 0; edge < kCellEdges; ++edge) {
    if (cells_[at(cell)].pieces.piece_of_edge[static_cast<std::size_t>(edge)] != piece) continue;
    const Crossing& crossing = crossings_[static_cast<std::size_t>(crossing_of(cell, edge))];
    planes.push_back(crossing.plane);
    normals += crossing.plane.normal;
    colors += Eigen::Vector3f(crossing.color.r, crossing.color.g, crossing.color.b);
    confidence_eighths += static_cast<float>(crossing.confidence_eighths);
  }
  const EdgeVertex met = meet(planes);
  CubeVertex vertex;
  vertex.key = vertex_key(first_cell_ + cell, piece);
  vertex.is_smooth = met.rank == 1;
  vertex.position_m = met.position_m;
  vertex.normal =
      normals.norm() > 0 ? Eigen::Vector3f(normals.normalized()) : planes.front().normal;
  colors /= static_cast<float>(planes.size());
  confidence_eighths /= static_cast<float>(planes.size());
  const auto cell_m = static_cast<float>(field_.cell_m());
  FieldSample sample = window_.sample(vertex.position_m);
  if (vertex.is_smooth && sample.kernel_count >= kLeastKernels &&
      std::abs(sample.value_m) < cell_m) {
    vertex.position_m -= sample.value_m * sample.normal;
    vertex.normal = sample.normal;
    colors = sample.color;
    confidence_eighths = sample.confidence_eighths;
  }
  const Eigen::Vector3f inset_m = Eigen::Vector3f::Constant(kInset_cells * cell_m);
  vertex.position_m = vertex.position_m.cwiseMax(position_m(cell) + inset_m)
                          .cwiseMin(position_m(cell + Eigen::Vector3i::Ones()) - inset_m);
  sample = window_.sample(vertex.position_m);
  vertex.is_supported = sample.kernel_count > 0 &&
                        sample.nearest_m < std::max(kFarthest_cells * cell_m,
                                                    kFarthest_supports * sample.nearest_support_m);
  vertex.color = {byte_of(colors.x()), byte_of(colors.y()), byte_of(colors.z())};
  vertex.confidence_eighths = byte_of(confidence_eighths);
  return vertex;
}

void CubeContour::make_quads(CubeSurface& surface) const {
  for_each(kMargin, kMargin + kCubeCells, [&](const Eigen::Vector3i& corner) {
    for (int axis = 0; axis < 3; ++axis)
      if (crossing_by_edge_[at(corner)][static_cast<std::size_t>(axis)] >= 0)
        make_quad(corner, axis, surface);
  });
}

void CubeContour::make_quad(const Eigen::Vector3i& corner, int axis, CubeSurface& surface) const {
  const Eigen::Vector3i b = Eigen::Vector3i::Unit((axis + 1) % 3),
                        c = Eigen::Vector3i::Unit((axis + 2) % 3);
  // The cells around the edge, counter-clockwise seen from its upper end, by their offsets below
  // along b and c. The same offsets give the position of the edge within these cells.
  constexpr std::array<std::array<int, 2>, 4> kAround = {{{1, 1}, {0, 1}, {0, 0}, {1, 0}}};
  CubeQuad quad{};
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector3i cell = corner - kAround[i][0] * b - kAround[i][1] * c;
    const int edge = 4 * axis + kAround[i][0] + 2 * kAround[i][1];
    quad[i] = vertex_key(first_cell_ + cell,
                         cells_[at(cell)].pieces.piece_of_edge[static_cast<std::size_t>(edge)]);
  }
  if (sides_[at(corner)] == Side::kOutside) std::reverse(quad.begin(), quad.end());
  surface.quads.push_back(quad);
}

}  // namespace

VertexKey vertex_key(const Eigen::Vector3i& cell, int piece) {
  const auto part = [](int value) { return static_cast<VertexKey>(value + kMostCell); };
  return part(cell.z()) << 44 | part(cell.y()) << 24 | part(cell.x()) << 4 |
         static_cast<VertexKey>(piece);
}

Eigen::Vector3i cell_of(VertexKey key) {
  const auto part = [key](int shift) {
    return static_cast<int>(key >> shift & (2 * kMostCell - 1)) - kMostCell;
  };
  return {part(4), part(24), part(44)};
}

Eigen::Vector3i cube_of(const Eigen::Vector3i& cell) {
  const auto part = [](int value) {
    return value >= 0 ? value / kCubeCells : -((kCubeCells - 1 - value) / kCubeCells);
  };
  return {part(cell.x()), part(cell.y()), part(cell.z())};
}

CubeSurface contour_cube(const SurfelField& field, const Eigen::Vector3i& cube) {
  return CubeContour(field, cube).contour(0);
}

CubeSurface contour_whole_cube(const SurfelField& field, const Eigen::Vector3i& cube) {
  return CubeContour(field, cube).contour(1);
}

}  // namespace hermite::mesh
