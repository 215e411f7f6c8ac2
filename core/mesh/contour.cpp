#include "core/mesh/contour.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <mutex>
#include <set>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "core/base/parallel.h"
#include "core/mesh/contour_cube.h"
#include "core/mesh/mesh_parts.h"
#include "core/mesh/quad_mesh.h"

namespace hermite {
namespace {

struct CubeOrder {
  bool operator()(const Eigen::Vector3i& a, const Eigen::Vector3i& b) const {
    return std::make_tuple(a.z(), a.y(), a.x()) < std::make_tuple(b.z(), b.y(), b.x());
  }
};

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
    QuadMesh mesh;
    for (const CubeSurface& surface : surfaces_) mesh.add_vertices(surface.vertices);
    for (const CubeSurface& surface : surfaces_)
      for (const CubeQuad& quad : surface.quads) {
        std::array<std::uint32_t, 4> corners{};
        std::transform(quad.begin(), quad.end(), corners.begin(), [this](VertexKey key) { return number_of(key); });
        mesh.add(corners);
      }
    return mesh.take();
  }

 private:
  struct Place {
    std::size_t surface = 0;
    std::uint32_t first_vertex = 0;
  };
  static VertexKey key_of(const Eigen::Vector3i& cube) { return vertex_key(cube, 0); }

  std::uint32_t number_of(VertexKey key) const {
    const Place& place = places_.at(key_of(cube_of(cell_of(key))));
    return place.first_vertex + index_of(key, surfaces_[place.surface].vertices);
  }

  const std::vector<CubeSurface>& surfaces_;
  std::unordered_map<VertexKey, Place> places_;
};

// Counts what is done and tells it, one call at a time; after a "stop" no more.
class ToldProgress {
 public:
  ToldProgress(const MeshProgress& progress, std::size_t count) : progress_(progress), count_(count) {}

  bool stopped() const { return stopped_; }
  void add_one() {
    const std::lock_guard lock(mutex_);
    ++done_;
    if (progress_ && !stopped_ && !progress_(static_cast<double>(done_) / static_cast<double>(count_))) stopped_ = true;
  }

 private:
  const MeshProgress& progress_;
  const std::size_t count_;
  std::mutex mutex_;
  std::size_t done_ = 0;
  std::atomic<bool> stopped_ = false;
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
