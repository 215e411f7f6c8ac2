#include "core/texture/chart_growth.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <tuple>

namespace hermite::texture {

namespace {

using Eigen::Vector3f;

constexpr float kSmoothNormalWithin = 0.70710678f;  // cosine of 45 degrees
constexpr float kOwnNormalWithin = 0.25881905f;     // cosine of 75 degrees
// Below this number of triangles a chart is mostly gutter.
constexpr std::size_t kSmallChart = 24;
constexpr int kSmoothings = 3;
// States of a triangle that is in no chart.
constexpr std::uint32_t kNotAsked = 0xffffffff, kWaiting = 0xfffffffe;

struct Edge {
  std::uint32_t low, high, triangle, corner;
  bool operator<(const Edge& other) const {
    return std::tie(low, high, triangle, corner) <
           std::tie(other.low, other.high, other.triangle, other.corner);
  }
};

Vector3f unit_or_zero(const Vector3f& v) {
  const float length = v.norm();
  return length > 0 && std::isfinite(length) ? Vector3f(v / length) : Vector3f(Vector3f::Zero());
}

}  // namespace

std::vector<std::array<std::uint32_t, 3>> neighbours_of(const output::TriangleMesh& mesh) {
  std::vector<Edge> edges;
  edges.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[t][k], b = mesh.triangles[t][(k + 1) % 3];
      edges.push_back({std::min(a, b), std::max(a, b), t, k});
    }
  std::sort(edges.begin(), edges.end());
  std::vector<std::array<std::uint32_t, 3>> neighbours(mesh.triangles.size(),
                                                       {kNoNeighbour, kNoNeighbour, kNoNeighbour});
  for (std::size_t first = 0, last = 0; first < edges.size(); first = last) {
    while (last < edges.size() && edges[last].low == edges[first].low &&
           edges[last].high == edges[first].high)
      ++last;
    if (last - first != 2) continue;
    neighbours[edges[first].triangle][edges[first].corner] = edges[first + 1].triangle;
    neighbours[edges[first + 1].triangle][edges[first + 1].corner] = edges[first].triangle;
  }
  return neighbours;
}

struct ChartGrower::Frontier {
  std::deque<std::uint32_t> queue;
  Vector3f normal_sum = Vector3f::Zero();  // weighted by area
  Eigen::Matrix<float, 2, 3> plane;        // coordinates in the plane of the first triangle
  Eigen::Vector2f low, high;

  Vector3f mean_normal() const { return unit_or_zero(normal_sum); }
};

ChartGrower::ChartGrower(const output::TriangleMesh& mesh, double max_side_m)
    : mesh_(mesh),
      max_side_m_(static_cast<float>(max_side_m)),
      neighbours_(neighbours_of(mesh)),
      faces_(mesh.triangles.size()) {
  chart_of_.assign(mesh.triangles.size(), kNotAsked);
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    const output::TriangleCorners& t = mesh.triangles[i];
    const Vector3f& a = mesh.positions_m[t[0]];
    const Vector3f cross = (mesh.positions_m[t[1]] - a).cross(mesh.positions_m[t[2]] - a);
    faces_[i].area_m2 = 0.5f * cross.norm();
    faces_[i].normal = unit_or_zero(cross);
    faces_[i].smooth_normal = faces_[i].area_m2 * faces_[i].normal;
  }
  std::vector<Vector3f> around(faces_.size());
  for (int round = 0; round < kSmoothings; ++round) {
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      around[i] = faces_[i].smooth_normal;
      for (const std::uint32_t neighbour : neighbours_[i])
        if (neighbour != kNoNeighbour) around[i] += faces_[neighbour].smooth_normal;
    }
    for (std::size_t i = 0; i < faces_.size(); ++i) faces_[i].smooth_normal = around[i];
  }
  for (Face& face : faces_) face.smooth_normal = unit_or_zero(face.smooth_normal);
}

bool ChartGrower::fits(const Frontier& frontier, std::uint32_t triangle) const {
  const Face& face = faces_[triangle];
  const Vector3f mean = frontier.mean_normal();
  // A triangle without area fits everywhere.
  if (face.normal.squaredNorm() > 0 && (face.smooth_normal.dot(mean) < kSmoothNormalWithin ||
                                        face.normal.dot(mean) < kOwnNormalWithin))
    return false;
  Eigen::Vector2f low = frontier.low, high = frontier.high;
  for (const std::uint32_t corner : mesh_.triangles[triangle]) {
    const Eigen::Vector2f at = frontier.plane * mesh_.positions_m[corner];
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  return (high - low).maxCoeff() <= max_side_m_;
}

Chart ChartGrower::grow_from(std::uint32_t seed) {
  Frontier frontier;
  // If the smoothed normal would show the triangle from behind or nearly edge-on, its own normal is
  // the chart's first one.
  const Face& first = faces_[seed];
  Vector3f normal =
      first.normal.dot(first.smooth_normal) > kOwnNormalWithin ? first.smooth_normal : first.normal;
  if (normal.squaredNorm() == 0) normal = Vector3f::UnitZ();
  const Vector3f side = normal.unitOrthogonal();
  frontier.plane.row(0) = side.transpose();
  frontier.plane.row(1) = normal.cross(side).transpose();
  frontier.low = frontier.high = frontier.plane * mesh_.positions_m[mesh_.triangles[seed][0]];
  Chart chart;
  const auto add = [&](std::uint32_t triangle) {
    chart_of_[triangle] = 0;  // in a chart; grow() sets which one
    chart.triangles.push_back(triangle);
    frontier.queue.push_back(triangle);
    frontier.normal_sum +=
        faces_[triangle].area_m2 * (triangle == seed ? normal : faces_[triangle].smooth_normal);
    for (const std::uint32_t corner : mesh_.triangles[triangle]) {
      const Eigen::Vector2f at = frontier.plane * mesh_.positions_m[corner];
      frontier.low = frontier.low.cwiseMin(at);
      frontier.high = frontier.high.cwiseMax(at);
    }
  };
  add(seed);
  if (frontier.normal_sum.squaredNorm() == 0) frontier.normal_sum = 1e-12f * normal;
  while (!frontier.queue.empty()) {
    const std::uint32_t from = frontier.queue.front();
    frontier.queue.pop_front();
    for (const std::uint32_t neighbour : neighbours_[from])
      if (neighbour != kNoNeighbour && chart_of_[neighbour] == kWaiting &&
          fits(frontier, neighbour))
        add(neighbour);
  }
  chart.normal = frontier.mean_normal();
  if (chart.normal.squaredNorm() == 0) chart.normal = normal;
  return chart;
}

std::vector<Chart> ChartGrower::grow(const std::vector<std::uint32_t>& candidates) {
  std::fill(chart_of_.begin(), chart_of_.end(), kNotAsked);
  for (const std::uint32_t triangle : candidates) chart_of_[triangle] = kWaiting;
  std::vector<Chart> charts;
  for (const std::uint32_t seed : candidates) {
    if (chart_of_[seed] != kWaiting) continue;
    charts.push_back(grow_from(seed));
    for (const std::uint32_t triangle : charts.back().triangles)
      chart_of_[triangle] = static_cast<std::uint32_t>(charts.size() - 1);
  }
  give_small_ones_away(charts);
  return charts;
}

// Moves the triangles of small charts to the adjacent large chart that fits each best, from the
// border inwards.
void ChartGrower::give_small_ones_away(std::vector<Chart>& charts) {
  std::vector<bool> is_large(charts.size());
  for (std::size_t i = 0; i < charts.size(); ++i)
    is_large[i] = charts[i].triangles.size() >= kSmallChart;
  for (std::size_t i = 0; i < charts.size(); ++i) {
    if (is_large[i]) continue;
    for (bool moved = true; moved && !charts[i].triangles.empty();) {
      moved = false;
      std::vector<std::uint32_t> kept;
      for (const std::uint32_t triangle : charts[i].triangles) {
        std::uint32_t best = kNotAsked;
        float best_cosine = kOwnNormalWithin;
        for (const std::uint32_t neighbour : neighbours_[triangle]) {
          if (neighbour == kNoNeighbour || chart_of_[neighbour] >= charts.size() ||
              !is_large[chart_of_[neighbour]])
            continue;
          const float cosine = faces_[triangle].normal.dot(charts[chart_of_[neighbour]].normal);
          if (cosine <= best_cosine) continue;
          best = chart_of_[neighbour];
          best_cosine = cosine;
        }
        if (best == kNotAsked) {
          kept.push_back(triangle);
          continue;
        }
        chart_of_[triangle] = best;
        charts[best].triangles.push_back(triangle);
        moved = true;
      }
      charts[i].triangles = std::move(kept);
    }
  }
  std::erase_if(charts, [](const Chart& chart) { return chart.triangles.empty(); });
}

}  // namespace hermite::texture
