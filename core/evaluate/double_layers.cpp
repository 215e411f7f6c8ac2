#include "core/evaluate/double_layers.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <unordered_map>

#include "core/base/check.h"

namespace hermite::evaluate {
namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr float kNear_m = 0.010f, kFar_m = 0.030f;
constexpr float kMostBeside_m = 0.010f, kUnknownRadius_m = 0.005f;
constexpr int kSparsest = 4;
constexpr float kSameSide = 0.70710678f;  // cosine of 45 degrees
// Two cells reach the farthest neighbour: sqrt(30^2 + 10^2) mm = 31.6 mm.
constexpr float kCell_m = 0.016f;
constexpr int kReach_cells = 2;
constexpr float kHalfDiagonal_m = 0.8660254f * kCell_m;
constexpr float kFarthestPoint_m = 10'000;  // cell indices then fit 20 bits per axis

std::uint64_t key_of(const Vector3i& cell) {
  const auto bits = [](int value) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(value) & 0x1fffffu);
  };
  return bits(cell.x()) | bits(cell.y()) << 21 | bits(cell.z()) << 42;
}

Vector3i cell_of(const Vector3f& point) { return (point / kCell_m).array().floor().cast<int>(); }

bool is_usable(const LayerPoint& point) {
  const float length2 = point.normal.squaredNorm();
  return point.position_m.allFinite() &&
         point.position_m.cwiseAbs().maxCoeff() <= kFarthestPoint_m && std::isfinite(length2) &&
         length2 > 0;
}

struct Sum {
  double offset_m = 0;
  int count = 0;
  void add(float offset) {
    offset_m += static_cast<double>(offset);
    ++count;
  }
  double mean_m() const { return offset_m / count; }
};

// Points sorted by their cell; a cell is a run of them.
class LayerGrid {
 public:
  explicit LayerGrid(const std::vector<LayerPoint>& cloud) {
    std::vector<std::pair<std::uint64_t, std::uint32_t>> keys;
    keys.reserve(cloud.size());
    for (std::uint32_t i = 0; i < cloud.size(); ++i)
      if (is_usable(cloud[i])) keys.emplace_back(key_of(cell_of(cloud[i].position_m)), i);
    std::sort(keys.begin(), keys.end());
    points_.reserve(keys.size());
    for (const auto& [key, index] : keys) {
      LayerPoint point = cloud[index];
      point.normal.normalize();
      const bool known = std::isfinite(point.radius_m) && point.radius_m > 0;
      point.radius_m = known ? std::min(point.radius_m, kMostBeside_m) : kUnknownRadius_m;
      if (cells_.empty() || cells_.back().key != key) {
        by_key_.emplace(key, cells_.size());
        cells_.push_back({key, cell_of(point.position_m), points_.size(), points_.size()});
      }
      points_.push_back(point);
      cells_.back().last = points_.size();
    }
  }

  std::int64_t point_count() const { return static_cast<std::int64_t>(points_.size()); }

  std::int64_t doubled_count() const {
    std::int64_t count = 0;
    std::vector<const Cell*> around;
    for (const Cell& cell : cells_) {
      cells_around(cell.place, around);
      for (std::size_t i = cell.first; i < cell.last; ++i)
        count += is_doubled(points_[i], around) ? 1 : 0;
    }
    return count;
  }

 private:
  struct Cell {
    std::uint64_t key;
    Vector3i place;
    std::size_t first, last;
    Vector3f middle_m() const { return kCell_m * (place.cast<float>().array() + 0.5f).matrix(); }
  };

  void cells_around(const Vector3i& place, std::vector<const Cell*>& around) const {
    around.clear();
    for (int z = -kReach_cells; z <= kReach_cells; ++z)
      for (int y = -kReach_cells; y <= kReach_cells; ++y)
        for (int x = -kReach_cells; x <= kReach_cells; ++x)
          if (const auto found = by_key_.find(key_of(place + Vector3i(x, y, z)));
              found != by_key_.end())
            around.push_back(&cells_[found->second]);
  }

  bool is_doubled(const LayerPoint& point, const std::vector<const Cell*>& around) const {
    Sum own, front, behind;  // the point itself is in its own layer
    for (const Cell* cell : around) {
      if (beside_m(point, cell->middle_m()) > kMostBeside_m + kHalfDiagonal_m) continue;
      for (std::size_t i = cell->first; i < cell->last; ++i) {
        const LayerPoint& other = points_[i];
        const float offset_m = point.normal.dot(other.position_m - point.position_m);
        if (std::abs(offset_m) > kFar_m || point.normal.dot(other.normal) < kSameSide) continue;
        if (beside_m(point, other.position_m) > other.radius_m) continue;
        (std::abs(offset_m) < kNear_m ? own : offset_m > 0 ? front : behind).add(offset_m);
      }
    }
    const auto is_another = [&own](const Sum& layer) {
      if (layer.count == 0 || kSparsest * layer.count < own.count) return false;
      const double apart_m = std::abs(layer.mean_m() - own.mean_m());
      return apart_m >= static_cast<double>(kNear_m) && apart_m <= static_cast<double>(kFar_m);
    };
    return is_another(front) || is_another(behind);
  }

  // Returns the distance of a place from the line through the point along its normal.
  static float beside_m(const LayerPoint& point, const Vector3f& place) {
    const Vector3f way = place - point.position_m;
    return (way - point.normal.dot(way) * point.normal).norm();
  }

  std::vector<LayerPoint> points_;
  std::vector<Cell> cells_;
  std::unordered_map<std::uint64_t, std::size_t> by_key_;  // only for look-up, never iterated
};

}  // namespace

DoubleLayers double_layers(const std::vector<LayerPoint>& cloud) {
  CHECK(cloud.size() < UINT32_MAX, "points are counted in 32 bits");
  const LayerGrid grid(cloud);
  DoubleLayers layers;
  layers.point_count = grid.point_count();
  layers.left_out_count = static_cast<std::int64_t>(cloud.size()) - layers.point_count;
  layers.doubled_count = grid.doubled_count();
  if (layers.point_count > 0)
    layers.share =
        static_cast<double>(layers.doubled_count) / static_cast<double>(layers.point_count);
  return layers;
}

std::string format_double_layers_json(const DoubleLayers& layers) {
  nlohmann::ordered_json json;
  json["layer_points"] = layers.point_count;
  json["layer_left_out"] = layers.left_out_count;
  json["layer_doubled"] = layers.doubled_count;
  json["layer_doubled_share"] = layers.share;
  return json.dump(2) + "\n";
}

}  // namespace hermite::evaluate
