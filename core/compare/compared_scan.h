// A finished scan, checked and prepared to be compared with another one. Thread-safe once it is not
// changed any more.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/dataset/trajectory.h"
#include "core/math/rigid3.h"
#include "core/mesh/surfel_grid.h"
#include "core/output/cloud.h"

namespace hermite::compare {

// Fewer surfels do not show a place.
inline constexpr std::size_t kLeastSurfels = 500;
// The diagonal of a scan's bounding box, without the outermost hundredth of its points along each
// axis: beyond these limits the unit is not the metre.
inline constexpr double kLeastExtent_m = 0.05, kMostExtent_m = 1000;

class ComparedScan {
 public:
  // `trajectory` has the poses of the scan's camera in the world of its surfels; empty if they are
  // unknown. Surfels whose position or normal is not finite, or whose normal is zero, are left out;
  // normals are normalised. In a cloud without confidences all points count alike. `name` begins
  // the message of each error: kInvalidArgument when fewer than kLeastSurfels are left or the
  // extent is out of range, kTooLarge when the extent has more bins than the grid.
  static Result<ComparedScan> create(output::Cloud cloud, dataset::Trajectory trajectory,
                                     const std::string& name);

  // The number of parts of its map: how they lie to each other is unknown.
  void set_part_count(std::int64_t count) { part_count_ = count; }
  std::int64_t part_count() const { return part_count_; }

  const output::Cloud& surfels() const { return surfels_; }
  const dataset::Trajectory& trajectory() const { return trajectory_; }
  std::size_t left_out_count() const { return left_out_count_; }
  double extent_m() const { return extent_m_; }
  // Whether its points have different colours: a cloud of one colour says nothing by it.
  bool has_color() const { return has_color_; }

  // Appends all surfels that are at most `reach_m` from a point, and some that are a little farther
  // away, in an order that depends on the scan alone.
  void append_near(const Eigen::Vector3d& point, double reach_m,
                   std::vector<output::CloudPoint>& found) const;

  // Calls use(surfel) for the same surfels.
  template <class Use>
  void for_each_near(const Eigen::Vector3d& point, double reach_m, const Use& use) const {
    const Eigen::Vector3f reach = Eigen::Vector3f::Constant(static_cast<float>(reach_m));
    const Eigen::Vector3f middle = point.cast<float>();
    grid_.for_each(middle - reach, middle + reach,
                   [&](std::uint32_t slot) { use(surfels_[slot]); });
  }

 private:
  explicit ComparedScan(double bin_m) : grid_(bin_m / mesh::SurfelGrid::kBinCells) {}

  output::Cloud surfels_;
  dataset::Trajectory trajectory_;
  std::size_t left_out_count_ = 0;
  std::int64_t part_count_ = 1;
  double extent_m_ = 0;
  bool has_color_ = false;
  mesh::SurfelGrid grid_;
};

// A sample of the surface: the surfel next to the middle of a cube, for each side of the surface in
// it.
struct SurfaceSample {
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero(), normal = Eigen::Vector3d::Zero();
  // Mean of the cube's surfels on that side, 0 to 255.
  Eigen::Vector3d color = Eigen::Vector3d::Zero();
  std::uint32_t surfel = 0;  // index of the surfel
};

struct SurfaceSamples {
  std::vector<SurfaceSample> samples;
  std::vector<std::uint32_t> of_surfel;  // the sample of each surfel
  double spacing_m = 0;
};

// Returns samples that are about `spacing_m` apart, in the order of their first surfels. If there
// would be more than `most`, the spacing grows.
SurfaceSamples surface_samples(const output::Cloud& surfels, double spacing_m, std::size_t most);

// The same surface in another coordinate frame.
output::Cloud moved_cloud(const output::Cloud& cloud, const Rigid3& target_from_source);
dataset::Trajectory moved_trajectory(const dataset::Trajectory& trajectory,
                                     const Rigid3& target_from_source);

}  // namespace hermite::compare
