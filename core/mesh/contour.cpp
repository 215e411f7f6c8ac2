#include "core/mesh/contour.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "core/base/parallel.h"
#include "core/mesh/contour_cube.h"
#include "core/mesh/mesh_parts.h"

namespace hermite {
namespace {

struct CubeOrder {
  bool operator()(const Eigen::Vector3i& a, const Eigen::Vector3i& b) const {
    return std::make_tuple(a.z(), a.y(), a.x()) < std::make_tuple(b.z(), b.y(), b.x());
  }
};

Eigen::Vector3i cube_of(const Eigen::Vector3i& cell) {
  const auto part = [](int value) { return value >= 0 ? value / kCubeCells : -((kCubeCells - 1 - value) / kCubeCells); };
  return {part(cell.x()), part(cell.y()), part(cell.z())};
}

// That a support reaches.
std::vector<Eigen::Vector3i> cubes_of(const SurfelField& field) {
  std::set<Eigen::Vector3i, CubeOrder> cubes;
  const auto reach_cells = static_cast<int>(std::ceil(static_cast<double>(field.reach_m()) / field.cell_m()));
  for (const Eigen::Vector3i& bin : field.bins()) {
    const Eigen::Vector3i first = cube_of(bin * SurfelField::kBinCells - Eigen::Vector3i::Constant(reach_cells));
    const Eigen::Vector3i last = cube_of((bin + Eigen::Vector3i::Ones()) * SurfelField::kBinCells + Eigen::Vector3i::Constant(reach_cells));
    for (int z = first.z(); z <= last.z(); ++z)
      for (int y = first.y(); y <= last.y(); ++y)
        for (int x = first.x(); x <= last.x(); ++x) cubes.insert(Eigen::Vector3i(x, y, z));
  }
  return {cubes.begin(), cubes.end()};
}

// Surfaces of cubes become one mesh, in the order of the cubes.
class Welder {
 public:
  Welder(const std::vector<Eigen::Vector3i>& cubes, const std::vector<CubeSurface>& surfaces) : surfaces_(surfaces) {
    std::uint32_t first = 0;
    for (std::size_t i = 0; i < cubes.size(); ++i) {
      if (surfaces[i].vertices.empty()) continue;
      places_.emplace(key_of(cubes[i]), Place{i, first});
      first += static_cast<std::uint32_t>(surfaces[i].vertices.size());
    }
  }

  TriangleMesh weld() {
    for (const CubeSurface& surface : surfaces_)
      for (const CubeVertex& vertex : surface.vertices) {
        mesh_.positions_m.push_back(vertex.position_m);
        mesh_.normals.push_back(vertex.normal);
        mesh_.colors.push_back(vertex.color);
        is_smooth_.push_back(vertex.is_smooth);
        is_supported_.push_back(vertex.is_supported);
      }
    for (const CubeSurface& surface : surfaces_)
      for (const CubeQuad& quad : surface.quads) add(quad);
    return std::move(mesh_);
  }

 private:
  struct Place {
    std::size_t surface = 0;
    std::uint32_t first_vertex = 0;
  };
  static VertexKey key_of(const Eigen::Vector3i& cube) { return vertex_key(cube, 0); }

  std::uint32_t index_of(VertexKey key) const {
    const Place& place = places_.at(key_of(cube_of(cell_of(key))));
    const std::vector<CubeVertex>& vertices = surfaces_[place.surface].vertices;
    const auto found = std::lower_bound(vertices.begin(), vertices.end(), key,
                                        [](const CubeVertex& vertex, VertexKey wanted) { return vertex.key < wanted; });
    CHECK(found != vertices.end() && found->key == key, "two cubes differ about what lies between them");
    return place.first_vertex + static_cast<std::uint32_t>(found - vertices.begin());
  }

  // How well a triangle goes with the normals at its corners; those on edges are of no side.
  float fit(const TriangleCorners& triangle) const {
    const auto& p = mesh_.positions_m;
    const Eigen::Vector3f across = (p[triangle[1]] - p[triangle[0]]).cross(p[triangle[2]] - p[triangle[0]]);
    const float length = across.norm();
    if (!(length > 0)) return -1;  // no triangle
    float least = 1;
    for (const std::uint32_t vertex : triangle)
      if (is_smooth_[vertex]) least = std::min(least, across.dot(mesh_.normals[vertex]) / length);
    return least;
  }

  void add(const CubeQuad& quad) {
    std::array<std::uint32_t, 4> v{};
    for (std::size_t i = 0; i < 4; ++i) {
      v[i] = index_of(quad[i]);
      if (!is_supported_[v[i]]) return;
    }
    const std::array<TriangleCorners, 2> one = {{{v[0], v[1], v[2]}, {v[0], v[2], v[3]}}},
                                         other = {{{v[0], v[1], v[3]}, {v[1], v[2], v[3]}}};
    const float fit_of_one = std::min(fit(one[0]), fit(one[1])), fit_of_other = std::min(fit(other[0]), fit(other[1]));
    const auto diagonal2 = [this](std::uint32_t a, std::uint32_t b) { return (mesh_.positions_m[a] - mesh_.positions_m[b]).squaredNorm(); };
    constexpr float kAlike = 0.01f;
    const bool takes_one =
        std::abs(fit_of_one - fit_of_other) > kAlike ? fit_of_one > fit_of_other : diagonal2(v[0], v[2]) <= diagonal2(v[1], v[3]);
    for (const TriangleCorners& triangle : takes_one ? one : other) mesh_.triangles.push_back(triangle);
  }

  const std::vector<CubeSurface>& surfaces_;
  std::unordered_map<VertexKey, Place> places_;
  std::vector<bool> is_smooth_, is_supported_;  // by vertex
  TriangleMesh mesh_;
};

}  // namespace

Result<TriangleMesh> contour(const Cloud& cloud, const ContourOptions& options, const MeshProgress& progress,
                             ContourStatistics* statistics) {
  const Result<SurfelField> field = SurfelField::create(cloud, options.field);
  if (!field.ok()) return field.error();
  const std::vector<Eigen::Vector3i> cubes = cubes_of(*field);
  std::vector<CubeSurface> surfaces(cubes.size());
  ToldProgress told(progress, cubes.size());
  in_parallel(cubes.size(), [&](std::size_t i) {
    if (told.stopped()) return;
    surfaces[i] = contour_cube(*field, cubes[i]);
    told.add_one();
  });
  if (told.stopped()) return Error{ErrorCode::kBusy, "meshing was stopped"};
  TriangleMesh mesh = Welder(cubes, surfaces).weld();
  const std::size_t folded = unfold(mesh);
  const std::size_t split = split_touching_fans(mesh);
  const std::size_t removed = remove_small_parts(mesh, options.least_part_m2);
  if (statistics) *statistics = {field->cell_m(), field->rejected_count(), removed, split, folded};
  return mesh;
}

}  // namespace hermite
