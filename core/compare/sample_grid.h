// Finds samples of a surface by position. Immutable after construction; thread-safe. It refers to
// the samples, which must outlive it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "core/compare/compared_scan.h"
#include "core/mesh/surfel_grid.h"

namespace hermite::compare {

class SampleGrid {
 public:
  // `reach_m` is the usual reach of searches.
  SampleGrid(std::span<const SurfaceSample> samples, double reach_m)
      : samples_(samples), grid_(reach_m / mesh::SurfelGrid::kBinCells) {
    for (std::size_t i = 0; i < samples.size(); ++i)
      grid_.insert(static_cast<std::uint32_t>(i), samples[i].position_m.cast<float>());
  }

  // Calls use(index) for all samples at most `reach_m` from the point, in an order that depends on
  // the samples alone.
  template <class Use>
  void for_each_within(const Eigen::Vector3d& point, double reach_m, const Use& use) const {
    const Eigen::Vector3f reach = Eigen::Vector3f::Constant(static_cast<float>(reach_m)),
                          middle = point.cast<float>();
    grid_.for_each(middle - reach, middle + reach, [&](std::uint32_t i) {
      if ((samples_[i].position_m - point).squaredNorm() <= reach_m * reach_m) use(i);
    });
  }

  // Returns the nearest sample within the reach whose normal is at least this similar (cosine).
  std::optional<std::uint32_t> nearest(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                                       double reach_m, double least_cosine) const;

  const SurfaceSample& sample(std::uint32_t i) const { return samples_[i]; }
  std::size_t size() const { return samples_.size(); }

 private:
  std::span<const SurfaceSample> samples_;
  mesh::SurfelGrid grid_;
};

}  // namespace hermite::compare
