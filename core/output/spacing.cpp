#include "core/output/spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <nanoflann.hpp>
#include <numbers>

#include "core/base/check.h"
#include "core/base/parallel.h"

namespace hermite::output {
namespace {

constexpr std::size_t kLeafPoints = 16, kSpacingsAtOnce = 4096;

struct TreePoints {
  const std::vector<Eigen::Vector3f>& positions_m;
  std::size_t kdtree_get_point_count() const { return positions_m.size(); }
  float kdtree_get_pt(std::size_t index, std::size_t axis) const {
    return positions_m[index][static_cast<Eigen::Index>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

}  // namespace

std::vector<float> spacings_of_positions_m(const std::vector<Eigen::Vector3f>& positions_m) {
  using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, TreePoints>,
                                                   TreePoints, 3, std::uint32_t>;
  std::vector<float> spacings(positions_m.size(), 0);
  if (positions_m.size() < 2) return spacings;
  for (const Eigen::Vector3f& position_m : positions_m)
    CHECK(position_m.allFinite(), "a position is not finite");
  const TreePoints points{positions_m};
  const Tree tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafPoints));
  const std::size_t neighbours = std::min(kSpacingNeighbours, positions_m.size() - 1);
  const float edge_per_reach =
      std::sqrt(std::numbers::pi_v<float> / static_cast<float>(neighbours));
  in_parallel((positions_m.size() + kSpacingsAtOnce - 1) / kSpacingsAtOnce, [&](std::size_t piece) {
    std::array<std::uint32_t, kSpacingNeighbours + 1> found{};  // includes the point itself
    std::array<float, kSpacingNeighbours + 1> squares{};
    for (std::size_t i = piece * kSpacingsAtOnce;
         i < std::min((piece + 1) * kSpacingsAtOnce, positions_m.size()); ++i) {
      tree.knnSearch(positions_m[i].data(), neighbours + 1, found.data(), squares.data());
      spacings[i] = edge_per_reach * std::sqrt(squares[neighbours]);
    }
  });
  return spacings;
}

std::vector<float> point_spacings_m(const Cloud& cloud) {
  std::vector<Eigen::Vector3f> positions_m;
  positions_m.reserve(cloud.size());
  for (const CloudPoint& point : cloud) positions_m.push_back(point.position_m);
  return spacings_of_positions_m(positions_m);
}

}  // namespace hermite::output
