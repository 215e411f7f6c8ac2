// The surface of a growing model, cube by cube: only cubes whose surfels changed are contoured
// again.
//
//   LiveSurface surface(*cell_for(surfels));
//   surface.place(submaps, now);
//   surface.apply(changes, now);
//   while (std::optional<SurfaceCube> cube = surface.next(eye_m, now))
//     if (auto mesh = surface.contour(*cube, now)) show(*mesh);
//
// Cubes of kCubeCells cells lie in a world grid, one for each part of the map, and contain the
// surfels of all submaps there, so that overlapping submaps give one surface. The mesh of a cube is
// in the frame of the submap that most of its surfels belong to, and moves with that submap when
// the map is corrected. It depends only on the surfels and submap poses that are held here, bit for
// bit, not on their history or on which cubes were made before. Adjacent cubes that are made from
// the same surfels fit without a gap.
//
// Changes of a surfel that would not be visible are ignored (the kAlike constants in the .cpp), and
// a submap keeps its held pose until it has moved by more than kMoved_cells. The mesh may differ
// from the present model by that much. Its confidences are as new as the piece, which is made again
// when one of them passes a step of coverage.
//
// Memory: 64 bytes per slot up to the highest one used and 20 per surfel; beyond kMostLiveSurfels,
// or twice as many slots, is_full() is true and the owner destroys it: 0.3 GB at most. One owner,
// one thread at a time.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <compare>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <vector>

#include "core/base/image.h"
#include "core/math/rigid3.h"
#include "core/mesh/surfel_field.h"
#include "core/mesh/surfel_grid.h"
#include "core/output/cloud.h"
#include "core/output/triangle_mesh.h"

namespace hermite::mesh {

inline constexpr std::size_t kMostLiveSurfels = 2'000'000;
// How far a submap may move, in cells, before its surfels are placed again: less than half their
// distance.
inline constexpr double kMoved_cells = 0.4;
// A cube that changes slightly all the time, as those in view do, is contoured again no sooner than
// this after the last time.
inline constexpr std::chrono::milliseconds kCubeRest(1000);

// Returns the cell size of a live surface: 1.25 times the median distance of the surfels, clamped
// to 1 to 4 cm. With finer cells, two processors do not keep up with the frames. Returns
// std::nullopt for fewer than 200 surfels, which are too few to measure their distance.
std::optional<double> live_cell_m(std::span<const output::SlotChange> surfels);

struct PlacedSubmap {
  Rigid3 world_from_submap;
  std::uint32_t part = 0;  // the relative pose of submaps of different parts is unknown
};

struct SurfaceCube {
  std::uint32_t part = 0;
  std::int16_t x = 0, y = 0, z = 0;
  auto operator<=>(const SurfaceCube&) const = default;
};

struct CubeMesh {
  SurfaceCube cube;
  std::uint32_t submap = 0;
  // In the frame of the submap; without triangles: the cube has become empty.
  output::TriangleMesh mesh;
  // The time of the oldest change that the previous mesh did not show.
  std::chrono::steady_clock::time_point since;
};

class LiveSurface {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // `cell_m`: kLeastCell_m to kMostCell_m (CHECK).
  explicit LiveSurface(double cell_m, std::size_t most_surfels = kMostLiveSurfels);

  double cell_m() const { return cell_m_; }

  // Sets the poses of the submaps, by number; later changes refer to these. Surfels of submaps that
  // are no longer listed stay until a change removes them.
  void place(std::span<const PlacedSubmap> submaps, Time now);

  // Applies changes that arrived at `now`. Surfels that are not finite, have a zero normal or no
  // confidence, or are too far from the origin for the cell index, count as removed. CHECK: the
  // submap was placed.
  void apply(std::span<const output::SlotChange> changes, Time now);

  std::size_t surfel_count() const { return surfel_count_; }
  bool is_full() const {
    return surfel_count_ > most_surfels_ || entries_.size() > 2 * kMostLiveSurfels;
  }
  std::size_t dirty_count() const { return dirty_.size(); }

  // Returns the cube to contour next: first those with much new surface, by distance to `eye_m`;
  // then the one that has waited longest. Returns std::nullopt if none is due.
  std::optional<SurfaceCube> next(const Eigen::Vector3f& eye_m, Time now) const;

  // Returns std::nullopt if the cube was empty and still is.
  std::optional<CubeMesh> contour(const SurfaceCube& cube, Time now);

  // Returns all cubes whose last mesh was not empty.
  std::vector<SurfaceCube> shown() const;

 private:
  struct Entry {
    // In the frame of the submap.
    Eigen::Vector3f position_m = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();
    Eigen::Vector3f world_m = Eigen::Vector3f::Zero();
    float confidence = 0;  // at most kMostConfidence; 0: none
    Rgb8 color;
    std::uint8_t confidence_eighths = 0;  // always the newest, and not capped as the confidence is
    std::uint32_t submap = 0;
    std::int32_t neighbours = 0;  // within kNeighbourhood_cells, including itself
  };
  struct Submap {
    // The pose at which its surfels are placed.
    PlacedSubmap placed;
    // Bounds of its surfels in its own frame.
    Eigen::Vector3f low_m = Eigen::Vector3f::Zero(), high_m = Eigen::Vector3f::Zero();
    bool is_used = false;
  };
  struct Cube {
    std::int32_t surfels = 0;       // within it
    std::int32_t came_or_went = 0;  // surfels added or removed since it was last contoured
    bool was_made = false, is_shown = false;
    Time since, made;
  };

  static std::optional<Entry> entry_of(const output::CloudPoint& point);
  bool is_at_one_place(const Entry& a, const Entry& b) const;
  static bool looks_alike(const Entry& a, const Entry& b);
  bool is_in_reach(const Eigen::Vector3f& world_m) const;
  float spacing_m(std::int32_t neighbours) const;
  float radius_m(std::int32_t neighbours) const;  // of the support
  SurfelGrid& grid_of(std::uint32_t part);
  void insert(std::uint32_t slot, Time now);
  void remove(std::uint32_t slot, Time now);
  void repaint(std::uint32_t slot, const Entry& as, Time now);
  void set_confidence_eighths(std::uint32_t slot, std::uint8_t eighths, Time now);
  void count_neighbour(std::uint32_t slot, int by, Time now);
  void touch(std::uint32_t part, const Eigen::Vector3f& world_m, float reach_m, Time now);
  Cube& cube_around(std::uint32_t slot);
  bool has_moved(const Submap& submap, const PlacedSubmap& now) const;
  void move(std::uint32_t submap, const PlacedSubmap& to, Time now);
  Eigen::Vector3f corner_m(const Eigen::Vector3i& cell) const {
    return (cell.cast<double>() * cell_m_).cast<float>();
  }
  FieldKernel kernel_of(const Entry& entry) const;
  std::vector<FieldKernel> kernels_around(const SurfaceCube& cube, std::uint32_t& submap) const;

  const double cell_m_;
  const std::size_t most_surfels_;
  std::vector<Entry> entries_;  // by slot
  std::vector<Submap> submaps_;
  std::map<std::uint32_t, SurfelGrid> grid_of_part_;
  std::map<SurfaceCube, Cube> cubes_;
  std::set<SurfaceCube> dirty_;
  std::size_t surfel_count_ = 0;
};

}  // namespace hermite::mesh
