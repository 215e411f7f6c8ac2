#include "core/mesh/contour.h"

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "core/base/parallel.h"
#include "core/mesh/contour_cube.h"
#include "core/mesh/mesh_parts.h"
#include "core/mesh/quad_mesh.h"

namespace hermite::mesh {
namespace {

// Number of cubes contoured before they are welded together: enough work for all processors in
// little memory.
constexpr std::size_t kCubesAtOnce = 256;

struct CubeOrder {
  bool operator()(const Eigen::Vector3i& a, const Eigen::Vector3i& b) const {
    return std::make_tuple(a.z(), a.y(), a.x()) < std::make_tuple(b.z(), b.y(), b.x());
  }
};

// Returns the cubes that the support of a surfel can reach.
std::vector<Eigen::Vector3i> cubes_of(const SurfelField& field) {
  std::set<Eigen::Vector3i, CubeOrder> cubes;
  const auto reach_cells =
      static_cast<int>(std::ceil(static_cast<double>(field.reach_m()) / field.cell_m()));
  for (const Eigen::Vector3i& bin : field.bins()) {
    const Eigen::Vector3i first =
        cube_of(bin * SurfelField::kBinCells - Eigen::Vector3i::Constant(reach_cells));
    const Eigen::Vector3i last = cube_of((bin + Eigen::Vector3i::Ones()) * SurfelField::kBinCells +
                                         Eigen::Vector3i::Constant(reach_cells));
    for (int z = first.z(); z <= last.z(); ++z)
      for (int y = first.y(); y <= last.y(); ++y)
        for (int x = first.x(); x <= last.x(); ++x) cubes.insert(Eigen::Vector3i(x, y, z));
  }
  return {cubes.begin(), cubes.end()};
}

// Welds the surfaces of cubes into one mesh, in the order of the cubes. A cube refers to its own
// vertices and to those of adjacent cubes that came before it, so only the vertices of the last
// layer of cubes are kept.
class Welder {
 public:
  void weld(const Eigen::Vector3i& cube, const CubeSurface& surface) {
    while (!layers_.empty() && layers_.begin()->first < cube.z() - 1)
      layers_.erase(layers_.begin());
    if (surface.vertices.empty()) return;
    Place& place = layers_[cube.z()][key_of(cube)];
    place.first_vertex = mesh_.vertex_count();
    place.keys.reserve(surface.vertices.size());
    for (const CubeVertex& vertex : surface.vertices) place.keys.push_back(vertex.key);
    mesh_.add_vertices(surface.vertices);
    for (const CubeQuad& quad : surface.quads) {
      std::array<std::uint32_t, 4> corners{};
      std::transform(quad.begin(), quad.end(), corners.begin(),
                     [this](VertexKey key) { return number_of(key); });
      mesh_.add(corners);
    }
  }

  output::TriangleMesh finish() { return mesh_.take(); }

 private:
  struct Place {
    std::uint32_t first_vertex = 0;
    std::vector<VertexKey> keys;  // of the cube's vertices
  };
  static VertexKey key_of(const Eigen::Vector3i& cube) { return vertex_key(cube, 0); }

  std::uint32_t number_of(VertexKey key) const {
    const Eigen::Vector3i cube = cube_of(cell_of(key));
    const Place& place = layers_.at(cube.z()).at(key_of(cube));
    return place.first_vertex + index_of(key, place.keys);
  }

  std::map<int, std::unordered_map<VertexKey, Place>> layers_;  // by z and cube
  QuadMesh mesh_;
};

Result<output::TriangleMesh> welded_cubes(const SurfelField& field, const MeshProgress& progress) {
  const std::vector<Eigen::Vector3i> cubes = cubes_of(field);
  ToldProgress told(progress, cubes.size());
  Welder welder;
  for (std::size_t first = 0; first < cubes.size(); first += kCubesAtOnce) {
    std::vector<CubeSurface> surfaces(std::min(kCubesAtOnce, cubes.size() - first));
    in_parallel(surfaces.size(), [&](std::size_t i) {
      if (told.stopped()) return;
      surfaces[i] = contour_cube(field, cubes[first + i]);
      told.add_one();
    });
    if (told.stopped()) return Error{ErrorCode::kBusy, "meshing was stopped"};
    for (std::size_t i = 0; i < surfaces.size(); ++i) welder.weld(cubes[first + i], surfaces[i]);
  }
  return welder.finish();
}

}  // namespace

Result<output::TriangleMesh> contour(output::Cloud&& cloud, const ContourOptions& options,
                                     const MeshProgress& progress, ContourStatistics* statistics) {
  std::optional<Result<SurfelField>> field = SurfelField::create(std::move(cloud), options.field);
  if (!field->ok()) return field->error();
  Result<output::TriangleMesh> mesh = welded_cubes(**field, progress);
  if (!mesh.ok()) return mesh;
  ContourStatistics counts{(*field)->cell_m(), (*field)->rejected_count()};
  field.reset();  // frees its memory for what follows
  counts.folded = unfold(*mesh);
  counts.split_vertices = split_touching_fans(*mesh);
  counts.removed_parts = remove_small_parts(*mesh, options.least_part_m2);
  if (statistics) *statistics = counts;
  return mesh;
}

Result<output::TriangleMesh> contour(const output::Cloud& cloud, const ContourOptions& options,
                                     const MeshProgress& progress, ContourStatistics* statistics) {
  return contour(output::Cloud(cloud), options, progress, statistics);
}

}  // namespace hermite::mesh
