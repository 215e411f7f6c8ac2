#include "core/evaluate/triangle_surface.h"

#include <algorithm>
#include <cmath>

namespace hermite::evaluate {

namespace {

using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr float kCell_m = 0.02f;
// Larger triangles are halved, because the bounding box of a slanted one would fill a volume of
// cells.
constexpr float kLongestEdge_m = 4 * kCell_m;
constexpr int kDeepest = 24;

std::uint64_t key_of(const Vector3i& cell) {
  const auto bits = [](int value) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(value) & 0x1fffffu);
  };
  return bits(cell.x()) | bits(cell.y()) << 21 | bits(cell.z()) << 42;
}

double distance_to_cell_m(const Vector3f& point, const Vector3i& cell) {
  const Vector3f low = cell.cast<float>() * kCell_m;
  return static_cast<double>(
      (point - point.cwiseMax(low).cwiseMin(low + Vector3f::Constant(kCell_m))).norm());
}

bool is_finite(const Triangle& t) {
  return t[0].allFinite() && t[1].allFinite() && t[2].allFinite();
}

}  // namespace

// Finds the closest point by the region of the triangle's plane into which the point projects
// (Ericson, Real-Time Collision Detection, 5.1.5).
double distance_to_triangle_m(const Vector3f& point, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  const Vector3f ab = b - a, ac = c - a, ap = point - a;
  const auto to = [&](const Vector3f& closest) {
    return static_cast<double>((point - closest).norm());
  };
  const float d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return to(a);
  const Vector3f bp = point - b;
  const float d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return to(b);
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return to(a + d1 / (d1 - d3) * ab);
  const Vector3f cp = point - c;
  const float d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return to(c);
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return to(a + d2 / (d2 - d6) * ac);
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0)
    return to(b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b));
  const float scale = 1 / (va + vb + vc);
  return to(a + vb * scale * ab + vc * scale * ac);
}

void append_depth_triangles(const DepthImage& depth, const Camera& camera,
                            const Rigid3& world_from_camera, int step,
                            std::vector<Triangle>& triangles) {
  const auto depth_m = [&](int x, int y) { return depth.at(x, y) / camera.depth_units_per_metre; };
  const auto vertex = [&](int x, int y) -> Vector3f {
    return (world_from_camera * camera.unproject(x, y, depth_m(x, y))).cast<float>();
  };
  const auto add = [&](std::array<std::array<int, 2>, 3> pixels) {
    double low = 1e9, high = 0;
    for (const auto& [x, y] : pixels) {
      low = std::min(low, depth_m(x, y));
      high = std::max(high, depth_m(x, y));
    }
    if (low <= 0 || high - low > 0.03 * low) return;
    triangles.push_back({vertex(pixels[0][0], pixels[0][1]), vertex(pixels[1][0], pixels[1][1]),
                         vertex(pixels[2][0], pixels[2][1])});
  };
  for (int y = 0; y + step < depth.height; y += step)
    for (int x = 0; x + step < depth.width; x += step) {
      add({{{x, y}, {x + step, y}, {x, y + step}}});
      add({{{x + step, y}, {x + step, y + step}, {x, y + step}}});
    }
}

TriangleSurface::TriangleSurface(const std::vector<Triangle>& triangles, double reach_m)
    : reach_m_(reach_m) {
  triangles_.reserve(triangles.size());
  for (const Triangle& triangle : triangles)
    if (is_finite(triangle)) insert(triangle, 0);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> entries;
  for (std::uint32_t i = 0; i < triangles_.size(); ++i) {
    const auto& [a, b, c] = triangles_[i];
    const Vector3i low = cell_of(a.cwiseMin(b).cwiseMin(c)),
                   high = cell_of(a.cwiseMax(b).cwiseMax(c));
    for (int z = low.z(); z <= high.z(); ++z)
      for (int y = low.y(); y <= high.y(); ++y)
        for (int x = low.x(); x <= high.x(); ++x) entries.emplace_back(key_of({x, y, z}), i);
  }
  std::sort(entries.begin(), entries.end());
  by_cell_.reserve(entries.size());
  for (std::uint32_t i = 0; i < entries.size(); ++i) {
    Range& range = cells_.try_emplace(entries[i].first, Range{i, i}).first->second;
    range.last = i + 1;
    by_cell_.push_back(entries[i].second);
  }
}

Vector3i TriangleSurface::cell_of(const Vector3f& point) const {
  return (point / kCell_m).array().floor().cast<int>();
}

void TriangleSurface::insert(const Triangle& triangle, int depth) {
  const auto& [a, b, c] = triangle;
  const std::array<float, 3> edges{(b - a).norm(), (c - b).norm(), (a - c).norm()};
  const auto longest =
      static_cast<std::size_t>(std::max_element(edges.begin(), edges.end()) - edges.begin());
  if (edges[longest] <= kLongestEdge_m || depth == kDeepest) {
    triangles_.push_back(triangle);
    return;
  }
  const Vector3f &from = triangle[longest], &to = triangle[(longest + 1) % 3],
                 &apex = triangle[(longest + 2) % 3];
  const Vector3f middle = 0.5f * (from + to);
  insert({from, middle, apex}, depth + 1);
  insert({middle, to, apex}, depth + 1);
}

double TriangleSurface::distance_m(const Eigen::Vector3d& point_m) const {
  const Vector3f point = point_m.cast<float>();
  const Vector3i centre = cell_of(point);
  const int rings = static_cast<int>(std::ceil(reach_m_ / static_cast<double>(kCell_m)));
  double best = reach_m_;
  // Cells of the next ring are at least `ring` cells away.
  for (int ring = 0; ring <= rings && best > (ring - 1) * static_cast<double>(kCell_m); ++ring)
    for (int z = -ring; z <= ring; ++z)
      for (int y = -ring; y <= ring; ++y) {
        const bool shell = std::abs(z) == ring || std::abs(y) == ring;
        for (int x = -ring; x <= ring; x += shell || ring == 0 ? 1 : 2 * ring) {
          const Vector3i at = centre + Vector3i(x, y, z);
          if (distance_to_cell_m(point, at) >= best) continue;
          const auto cell = cells_.find(key_of(at));
          if (cell == cells_.end()) continue;
          for (std::uint32_t i = cell->second.first; i < cell->second.last; ++i)
            best = std::min(best, distance_to_triangle_m(point, triangles_[by_cell_[i]]));
        }
      }
  return best;
}

}  // namespace hermite::evaluate
