// The surface of a growing model, cube by cube: what has changed is contoured anew, the rest stays as it is.
//
//   LiveSurface surface(*cell_for(surfels));
//   surface.place(submaps, now);
//   surface.apply(changes, now);
//   while (std::optional<SurfaceCube> cube = surface.next(eye_m, now)) if (auto mesh = surface.contour(*cube, now)) show(*mesh);
//
// Cubes of kCubeCells cells lie in the world, one grid for each part of the map, and are made of the surfels of all submaps there, so that
// one surface comes out where submaps overlap. The mesh of a cube is in the frame of the submap that most of it is of, and moves with that
// when the map is corrected. A cube is a function of the surfels that are held and of the poses at which they are: the way they came
// about, and which cubes were made before, change no bit of it. Neighbours that are made of the same surfels fit without a gap.
//
// What differs from what is held by less than can be seen is not taken over (kAlike... in the .cpp), and a submap stays where it was held
// until it has moved by more than kMoved_cells. So the mesh is as far from that of the model as it is now.
//
// Memory: 64 bytes a slot up to the highest one used and 20 a surfel; beyond kMostLiveSurfels, or twice as many slots, whoever owns it lets
// it go: 0.3 GB at most. One owner, one thread at a time.
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

namespace hermite {

inline constexpr std::size_t kMostLiveSurfels = 2'000'000;
// Of the cells in which a submap may stand elsewhere than its surfels are held: less than half their distance, which cells follow.
inline constexpr double kMoved_cells = 0.4;
// A surface that changes a little all the time, as one in view does, is made anew no more often.
inline constexpr std::chrono::milliseconds kCubeRest(1000);

// Of a live surface: 1.25 times the median distance of the surfels, within 1 and 4 cm. Finer ones take two processors more time than there
// is between frames. None: fewer than 200 surfels tell no distance.
std::optional<double> live_cell_m(std::span<const SlotChange> surfels);

struct PlacedSubmap {
  Rigid3 world_from_submap;
  std::uint32_t part = 0;  // submaps of different parts say nothing about each other's place
};

struct SurfaceCube {
  std::uint32_t part = 0;
  std::int16_t x = 0, y = 0, z = 0;
  auto operator<=>(const SurfaceCube&) const = default;
};

struct CubeMesh {
  SurfaceCube cube;
  std::uint32_t submap = 0;
  TriangleMesh mesh;                            // in the frame of the submap; without triangles: the cube is empty now
  std::chrono::steady_clock::time_point since;  // of the oldest change that was not shown before
};

class LiveSurface {
 public:
  using Time = std::chrono::steady_clock::time_point;

  // `cell_m`: kLeastCell_m to kMostCell_m (CHECK).
  explicit LiveSurface(double cell_m, std::size_t most_surfels = kMostLiveSurfels);

  double cell_m() const { return cell_m_; }

  // Where the submaps are, by number: all that the changes from now on are of. Of others that there were, surfels stay until they are told
  // to be gone.
  void place(std::span<const PlacedSubmap> submaps, Time now);

  // Surfels that are no numbers, have no direction or no confidence, or are too far from the origin for cells to be counted, are none.
  // CHECK: a submap that was placed. `now`: since when the changes are there, for CubeMesh::since.
  void apply(std::span<const SlotChange> changes, Time now);

  std::size_t surfel_count() const { return surfel_count_; }
  bool is_full() const { return surfel_count_ > most_surfels_ || entries_.size() > 2 * kMostLiveSurfels; }
  std::size_t dirty_count() const { return dirty_.size(); }

  // What to make next: where much is new comes first, nearest to `eye_m`; then what has waited longest. None: nothing that is due.
  std::optional<SurfaceCube> next(const Eigen::Vector3f& eye_m, Time now) const;

  // None: it was empty and still is.
  std::optional<CubeMesh> contour(const SurfaceCube& cube, Time now);

  // All cubes that were told of and not as empty.
  std::vector<SurfaceCube> shown() const;

 private:
  struct Entry {
    Eigen::Vector3f position_m = Eigen::Vector3f::Zero(), normal = Eigen::Vector3f::Zero();  // in the submap
    Eigen::Vector3f world_m = Eigen::Vector3f::Zero();
    float confidence = 0;  // 0: none
    Rgb8 color;
    std::uint32_t submap = 0;
    std::int32_t neighbours = 0;  // within kNeighbourhood_cells, itself among them
  };
  struct Submap {
    PlacedSubmap placed;                                                                // as its surfels are held
    Eigen::Vector3f low_m = Eigen::Vector3f::Zero(), high_m = Eigen::Vector3f::Zero();  // of its surfels, in itself
    bool is_used = false;
  };
  struct Cube {
    std::int32_t surfels = 0;       // within it
    std::int32_t came_or_went = 0;  // of these, since it was made
    bool was_made = false, is_shown = false;
    Time since, made;
  };

  static std::optional<Entry> entry_of(const CloudPoint& point);
  bool is_at_one_place(const Entry& a, const Entry& b) const;
  static bool looks_alike(const Entry& a, const Entry& b);
  bool is_in_reach(const Eigen::Vector3f& world_m) const;
  float spacing_m(std::int32_t neighbours) const;
  float radius_m(std::int32_t neighbours) const;  // of the support
  SurfelGrid& grid_of(std::uint32_t part);
  void insert(std::uint32_t slot, Time now);
  void remove(std::uint32_t slot, Time now);
  void repaint(std::uint32_t slot, const Entry& as, Time now);
  void count_neighbour(std::uint32_t slot, int by, Time now);
  void touch(std::uint32_t part, const Eigen::Vector3f& world_m, float reach_m, Time now);
  Cube& cube_around(std::uint32_t slot);
  bool has_moved(const Submap& submap, const PlacedSubmap& now) const;
  void move(std::uint32_t submap, const PlacedSubmap& to, Time now);
  Eigen::Vector3f corner_m(const Eigen::Vector3i& cell) const { return (cell.cast<double>() * cell_m_).cast<float>(); }
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

}  // namespace hermite
