#include "core/mesh/patch_refinement.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <utility>

namespace hermite::mesh {
namespace {

using Eigen::Vector3d;

// Liepa's density control factor: triangles that exceed the edge lengths at their corners by this
// factor are split.
const double kSplit = std::sqrt(2.0);
// Edge lengths grow by this factor with every ring inwards.
constexpr double kGrowth = 1.15;
constexpr int kMostRounds = 40, kMostTurnings = 10;
// Bounds the work for a very wide hole with very short boundary edges.
constexpr std::size_t kMostPatchPoints = 200'000;

class PatchRefiner {
 public:
  PatchRefiner(Patch& patch, const std::function<bool(std::size_t, std::size_t)>& is_taken)
      : patch_(patch), is_taken_(is_taken), edge_m_(patch.border_count) {
    for (std::uint32_t triangle = 0; triangle < patch.triangles.size(); ++triangle) enter(triangle);
    const auto& p = patch.points_m;
    const std::size_t count = patch.border_count;
    for (std::size_t i = 0; i < count; ++i)
      edge_m_[i] =
          0.5 * ((p[(i + 1) % count] - p[i]).norm() + (p[(i + count - 1) % count] - p[i]).norm());
  }

  void refine() {
    turn_edges();
    for (int round = 0; round < kMostRounds && split_large() > 0; ++round) turn_edges();
  }

 private:
  static std::uint64_t key(std::uint32_t from, std::uint32_t to) {
    return std::uint64_t{from} << 32 | to;
  }
  void enter(std::uint32_t triangle) {
    const output::TriangleCorners& t = patch_.triangles[triangle];
    for (std::size_t k = 0; k < 3; ++k) triangle_of_edge_[key(t[k], t[(k + 1) % 3])] = triangle;
  }
  bool is_border(std::uint32_t point) const { return point < patch_.border_count; }
  Vector3d across(std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    const auto& p = patch_.points_m;
    return (p[b] - p[a]).cross(p[c] - p[a]);
  }
  std::size_t split_large();
  bool turn_edges_once();
  void turn_edges() {
    for (int i = 0; i < kMostTurnings && turn_edges_once(); ++i) {
    }
  }
  bool turn(std::uint32_t triangle, std::size_t place);
  bool turns_well(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) const;

  Patch& patch_;
  const std::function<bool(std::size_t, std::size_t)>& is_taken_;
  std::vector<double> edge_m_;  // by point: the wanted edge length
  std::unordered_map<std::uint64_t, std::uint32_t>
      triangle_of_edge_;  // by its two points in winding order; only for look-up, never iterated
};

// Splits triangles at their centroids. Returns their number.
std::size_t PatchRefiner::split_large() {
  const std::size_t count = patch_.triangles.size();
  std::size_t split = 0;
  for (std::uint32_t triangle = 0; triangle < count && patch_.points_m.size() < kMostPatchPoints;
       ++triangle) {
    const auto [a, b, c] = patch_.triangles[triangle];
    const Vector3d middle_m = (patch_.points_m[a] + patch_.points_m[b] + patch_.points_m[c]) / 3;
    const double edge_m = kGrowth * (edge_m_[a] + edge_m_[b] + edge_m_[c]) / 3;
    const auto is_far = [&](std::uint32_t point) {
      return kSplit * (patch_.points_m[point] - middle_m).norm() > std::max(edge_m, edge_m_[point]);
    };
    if (!is_far(a) || !is_far(b) || !is_far(c)) continue;
    const auto middle = static_cast<std::uint32_t>(patch_.points_m.size());
    patch_.points_m.push_back(middle_m);
    edge_m_.push_back(edge_m);
    patch_.triangles[triangle] = {a, b, middle};
    patch_.triangles.push_back({b, c, middle});
    patch_.triangles.push_back({c, a, middle});
    enter(triangle);
    enter(static_cast<std::uint32_t>(patch_.triangles.size() - 2));
    enter(static_cast<std::uint32_t>(patch_.triangles.size() - 1));
    ++split;
  }
  return split;
}

bool PatchRefiner::turn_edges_once() {
  bool is_any = false;
  for (std::uint32_t triangle = 0; triangle < patch_.triangles.size(); ++triangle)
    for (std::size_t place = 0; place < 3; ++place) is_any = turn(triangle, place) || is_any;
  return is_any;
}

// Returns whether the edge a-b of the triangles a, b, c and b, a, d should be flipped to c-d
// (Delaunay): the angles at c and d add up to more than 180 degrees, and both new triangles face
// like the old ones.
bool PatchRefiner::turns_well(std::uint32_t a, std::uint32_t b, std::uint32_t c,
                              std::uint32_t d) const {
  const auto& p = patch_.points_m;
  const auto angle_rad = [&](std::uint32_t at) {
    const Vector3d to_a = p[a] - p[at], to_b = p[b] - p[at];
    return std::atan2(to_a.cross(to_b).norm(), to_a.dot(to_b));
  };
  // Otherwise the edges of four points on a circle would be flipped endlessly.
  constexpr double kMargin_rad = 1e-6;
  if (!(angle_rad(c) + angle_rad(d) > std::numbers::pi + kMargin_rad)) return false;
  const Vector3d mean = across(a, b, c) + across(b, a, d);
  return across(a, d, c).dot(mean) > 0 && across(d, b, c).dot(mean) > 0;
}

bool PatchRefiner::turn(std::uint32_t triangle, std::size_t place) {
  const output::TriangleCorners corners = patch_.triangles[triangle];
  const std::uint32_t a = corners[place], b = corners[(place + 1) % 3],
                      c = corners[(place + 2) % 3];
  const auto beyond = triangle_of_edge_.find(key(b, a));
  if (beyond == triangle_of_edge_.end()) return false;
  const std::uint32_t other = beyond->second;
  const output::TriangleCorners& others = patch_.triangles[other];
  const std::uint32_t d = others[0] != a && others[0] != b   ? others[0]
                          : others[1] != a && others[1] != b ? others[1]
                                                             : others[2];
  if (triangle_of_edge_.contains(key(c, d)) || triangle_of_edge_.contains(key(d, c))) return false;
  if (is_border(c) && is_border(d) && is_taken_(c, d)) return false;
  if (!turns_well(a, b, c, d)) return false;
  triangle_of_edge_.erase(key(a, b));
  triangle_of_edge_.erase(key(b, a));
  patch_.triangles[triangle] = {a, d, c};
  patch_.triangles[other] = {d, b, c};
  enter(triangle);
  enter(other);
  return true;
}

}  // namespace

void refine(Patch& patch, const std::function<bool(std::size_t, std::size_t)>& is_taken) {
  PatchRefiner(patch, is_taken).refine();
}

}  // namespace hermite::mesh
