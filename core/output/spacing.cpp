#include "core/output/spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/base/check.h"

namespace hermite {
namespace {

constexpr std::size_t kLeafPoints = 8;

// The squares of the k smallest distances so far, in order.
class Nearest {
 public:
  explicit Nearest(std::size_t count) : count_(count) { squares_.fill(std::numeric_limits<float>::infinity()); }
  void add(float square) {
    if (square >= farthest()) return;
    std::size_t at = count_ - 1;
    for (; at > 0 && squares_[at - 1] > square; --at) squares_[at] = squares_[at - 1];
    squares_[at] = square;
  }
  float farthest() const { return squares_[count_ - 1]; }

 private:
  const std::size_t count_;
  std::array<float, kSpacingNeighbours + 1> squares_{};
};

// Points in the order of a balanced tree: the middle one of a range splits the rest along the axis on which they reach farthest.
class KdTree {
 public:
  explicit KdTree(const Cloud& cloud) : points_(cloud.size()), axes_(cloud.size()) {
    for (std::size_t i = 0; i < cloud.size(); ++i) points_[i] = cloud[i].position_m;
    build(0, points_.size());
  }
  void search(const Eigen::Vector3f& at, Nearest& nearest) const { search(at, 0, points_.size(), nearest); }

 private:
  void build(std::size_t begin, std::size_t end) {
    if (end - begin <= kLeafPoints) return;
    Eigen::Vector3f low = points_[begin], high = low;
    for (std::size_t i = begin; i < end; ++i) {
      low = low.cwiseMin(points_[i]);
      high = high.cwiseMax(points_[i]);
    }
    int axis = 0;
    (high - low).maxCoeff(&axis);
    const std::size_t middle = begin + (end - begin) / 2;
    const auto at = [this](std::size_t i) { return points_.begin() + static_cast<std::ptrdiff_t>(i); };
    std::nth_element(at(begin), at(middle), at(end), [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
    axes_[middle] = static_cast<std::uint8_t>(axis);
    build(begin, middle);
    build(middle + 1, end);
  }
  void search(const Eigen::Vector3f& at, std::size_t begin, std::size_t end, Nearest& nearest) const {
    if (end - begin <= kLeafPoints) {
      for (std::size_t i = begin; i < end; ++i) nearest.add((points_[i] - at).squaredNorm());
      return;
    }
    const std::size_t middle = begin + (end - begin) / 2;
    const float beside = at[axes_[middle]] - points_[middle][axes_[middle]];
    nearest.add((points_[middle] - at).squaredNorm());
    const bool left_first = beside < 0;
    for (const bool left : {left_first, !left_first}) {
      if (left != left_first && beside * beside >= nearest.farthest()) return;
      left ? search(at, begin, middle, nearest) : search(at, middle + 1, end, nearest);
    }
  }

  std::vector<Eigen::Vector3f> points_;
  std::vector<std::uint8_t> axes_;  // of points that split
};

}  // namespace

std::vector<float> point_spacings_m(const Cloud& cloud) {
  std::vector<float> spacings(cloud.size(), 0);
  if (cloud.size() < 2) return spacings;
  for (const CloudPoint& point : cloud) CHECK(point.position_m.allFinite(), "a position that is not finite");
  const KdTree tree(cloud);
  const std::size_t neighbours = std::min(kSpacingNeighbours, cloud.size() - 1);
  const float edge_per_reach = std::sqrt(std::numbers::pi_v<float> / static_cast<float>(neighbours));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    Nearest nearest(neighbours + 1);  // it is one of them itself
    tree.search(cloud[i].position_m, nearest);
    spacings[i] = edge_per_reach * std::sqrt(nearest.farthest());
  }
  return spacings;
}

}  // namespace hermite
