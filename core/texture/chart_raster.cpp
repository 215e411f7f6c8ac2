#include "core/texture/chart_raster.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace hermite::texture {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

// Rotations of the bounding rectangle that are tried within a quarter turn.
constexpr int kTurns = 30;
// A centre this far inside a triangle is not on the border that it shares with the next one.
constexpr float kInside_texels = 0.05f;
// Cosine of 84 degrees: a triangle at a flatter angle would have a tenth of the texels that it
// needs.
constexpr float kFlattest = 0.1f;

struct FlatTriangle {
  std::array<Vector2f, 3> corners;
  float doubled_area = 0;   // positive if it is seen from outside
  std::uint32_t index = 0;  // in the mesh
};

FlatTriangle flat(const output::TriangleMesh& mesh, const FlatChart& chart,
                  std::uint32_t triangle) {
  FlatTriangle t;
  t.index = triangle;
  for (std::size_t i = 0; i < 3; ++i)
    t.corners[i] = chart.at(mesh.positions_m[mesh.triangles[triangle][i]]);
  const Vector2f ab = t.corners[1] - t.corners[0], ac = t.corners[2] - t.corners[0];
  t.doubled_area = ab.x() * ac.y() - ab.y() * ac.x();
  return t;
}

Vector3f weights_of(const FlatTriangle& t, const Vector2f& point) {
  const Vector2f ab = t.corners[1] - t.corners[0], ac = t.corners[2] - t.corners[0],
                 ap = point - t.corners[0];
  const float b = (ap.x() * ac.y() - ap.y() * ac.x()) / t.doubled_area,
              c = (ab.x() * ap.y() - ab.y() * ap.x()) / t.doubled_area;
  return {1 - b - c, b, c};
}

// Returns the barycentric weights of the nearest point of the triangle.
Vector3f nearest_weights(const FlatTriangle& t, const Vector2f& point) {
  if (std::abs(t.doubled_area) > 1e-6f) {
    const Vector3f inside = weights_of(t, point);
    if (inside.minCoeff() >= 0) return inside;
  }
  Vector3f best = Vector3f::UnitX();
  float best_distance2 = -1;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Vector2f &from = t.corners[static_cast<std::size_t>(i)],
                   way = t.corners[static_cast<std::size_t>(j)] - from;
    const float length2 = way.squaredNorm();
    const float share =
        length2 > 0 ? std::clamp((point - from).dot(way) / length2, 0.0f, 1.0f) : 0.0f;
    const float distance2 = (from + share * way - point).squaredNorm();
    if (best_distance2 >= 0 && distance2 >= best_distance2) continue;
    best_distance2 = distance2;
    best = Vector3f::Zero();
    best[i] = 1 - share;
    best[j] = share;
  }
  return best;
}

Vector2f point_of(const FlatTriangle& t, const Vector3f& weights) {
  return weights[0] * t.corners[0] + weights[1] * t.corners[1] + weights[2] * t.corners[2];
}

// Returns the distance of a point inside from the nearest side.
float depth_inside(const FlatTriangle& t, const Vector3f& weights) {
  float depth = 1e9f;
  for (std::size_t i = 0; i < 3; ++i) {
    const float side = (t.corners[(i + 2) % 3] - t.corners[(i + 1) % 3]).norm();
    depth = std::min(depth, weights[static_cast<Eigen::Index>(i)] * std::abs(t.doubled_area) /
                                std::max(side, 1e-9f));
  }
  return depth;
}

struct Box {
  int left, right, top, bottom;
};

// Returns the texels whose centres lie in the bounding rectangle of the triangle, extended by
// `margin`.
Box box_of(const FlatTriangle& t, float margin, const FlatChart& chart) {
  const Vector2f low = t.corners[0].cwiseMin(t.corners[1]).cwiseMin(t.corners[2]).array() - margin;
  const Vector2f high = t.corners[0].cwiseMax(t.corners[1]).cwiseMax(t.corners[2]).array() + margin;
  const auto first = [](float value) {
    return std::max(0, static_cast<int>(std::ceil(value - 0.5f)));
  };
  const auto last = [](float value, int side) {
    return std::min(side - 1, static_cast<int>(std::floor(value - 0.5f)));
  };
  return {first(low.x()), last(high.x(), chart.width), first(low.y()),
          last(high.y(), chart.height)};
}

Vector2f centre(int x, int y) {
  return {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
}

// Marks the texels whose centre is in the triangle; returns true if the triangle overlaps another.
bool cover(const FlatTriangle& t, const FlatChart& chart, Image<std::uint32_t>& covered,
           Image<float>& depth) {
  const Box box = box_of(t, 0, chart);
  for (int y = box.top; y <= box.bottom; ++y)
    for (int x = box.left; x <= box.right; ++x) {
      const Vector3f weights = weights_of(t, centre(x, y));
      if (weights.minCoeff() < 0 || covered.at(x, y) == kNoTexel) continue;
      if (std::min(depth_inside(t, weights), depth.at(x, y)) > kInside_texels) return true;
    }
  for (int y = box.top; y <= box.bottom; ++y)
    for (int x = box.left; x <= box.right; ++x) {
      const Vector3f weights = weights_of(t, centre(x, y));
      if (weights.minCoeff() < 0 || covered.at(x, y) != kNoTexel) continue;
      covered.at(x, y) = t.index;
      depth.at(x, y) = depth_inside(t, weights);
    }
  return false;
}

void reach_beside(const FlatTriangle& t, const FlatChart& chart,
                  const Image<std::uint32_t>& covered, Image<std::uint32_t>& reached,
                  Image<float>& distance2) {
  const Box box = box_of(t, kReach_texels, chart);
  for (int y = box.top; y <= box.bottom; ++y)
    for (int x = box.left; x <= box.right; ++x) {
      if (covered.at(x, y) != kNoTexel) continue;
      const float apart2 =
          (point_of(t, nearest_weights(t, centre(x, y))) - centre(x, y)).squaredNorm();
      if (apart2 > kReach_texels * kReach_texels || apart2 >= distance2.at(x, y)) continue;
      reached.at(x, y) = t.index;
      distance2.at(x, y) = apart2;
    }
}

}  // namespace

FlatChart flattened(const output::TriangleMesh& mesh, const Chart& chart, double texel_m,
                    int max_side_texels) {
  const Vector3f side = chart.normal.unitOrthogonal(), up = chart.normal.cross(side);
  std::vector<Vector2f> flat_points;
  flat_points.reserve(3 * chart.triangles.size());
  for (const std::uint32_t triangle : chart.triangles)
    for (const std::uint32_t corner : mesh.triangles[triangle])
      flat_points.emplace_back(side.dot(mesh.positions_m[corner]),
                               up.dot(mesh.positions_m[corner]));
  Eigen::Matrix2f best_turn = Eigen::Matrix2f::Identity();
  Vector2f best_low = Vector2f::Zero(), best_size = Vector2f::Zero();
  float best_area = -1;
  for (int i = 0; i < kTurns; ++i) {
    const float angle = static_cast<float>(i) * 1.5707963f / kTurns;
    Eigen::Matrix2f turn;
    turn << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    Vector2f low = Vector2f::Constant(1e30f), high = Vector2f::Constant(-1e30f);
    for (const Vector2f& point : flat_points) {
      const Vector2f turned = turn * point;
      low = low.cwiseMin(turned);
      high = high.cwiseMax(turned);
    }
    const float area = (high - low).prod();
    if (best_area >= 0 && area >= best_area) continue;
    best_area = area;
    best_turn = turn;
    best_low = low;
    best_size = high - low;
  }
  FlatChart result;
  result.triangles = chart.triangles;
  const int most = max_side_texels - 2 * kGutter_texels - 1;
  result.texel_m =
      std::max(static_cast<float>(texel_m), best_size.maxCoeff() / static_cast<float>(most));
  Eigen::Matrix<float, 2, 3> plane;
  plane.row(0) = side.transpose();
  plane.row(1) = up.transpose();
  result.texels_from_world = best_turn * plane / result.texel_m;
  result.offset = Vector2f::Constant(kGutter_texels) - best_low / result.texel_m;
  const auto texels = [&](float size_m) {
    return std::clamp(static_cast<int>(std::ceil(size_m / result.texel_m)), 1, most) +
           2 * kGutter_texels;
  };
  result.width = texels(best_size.x());
  result.height = texels(best_size.y());
  return result;
}

ChartRaster raster_of(const output::TriangleMesh& mesh, const FlatChart& chart) {
  ChartRaster raster{Image<std::uint32_t>(chart.width, chart.height), {}};
  std::fill(raster.triangle.pixels.begin(), raster.triangle.pixels.end(), kNoTexel);
  // How deep a centre is inside its triangle, later how far outside.
  Image<float> measure(chart.width, chart.height);
  for (const std::uint32_t triangle : chart.triangles) {
    const FlatTriangle t = flat(mesh, chart, triangle);
    const Vector3f a = mesh.positions_m[mesh.triangles[triangle][0]];
    const float area = (mesh.positions_m[mesh.triangles[triangle][1]] - a)
                           .cross(mesh.positions_m[mesh.triangles[triangle][2]] - a)
                           .norm();
    const float flat_area = area / (chart.texel_m * chart.texel_m);
    const bool is_flat = chart.triangles.size() > 1 && t.doubled_area < kFlattest * flat_area;
    if (is_flat || (t.doubled_area > 1e-6f && cover(t, chart, raster.triangle, measure)))
      raster.overlapping.push_back(triangle);
  }
  const Image<std::uint32_t> covered = raster.triangle;
  std::fill(measure.pixels.begin(), measure.pixels.end(), 1e9f);
  for (const std::uint32_t triangle : chart.triangles)
    reach_beside(flat(mesh, chart, triangle), chart, covered, raster.triangle, measure);
  return raster;
}

ChartPoint point_at(const output::TriangleMesh& mesh, const FlatChart& chart,
                    std::uint32_t triangle, int x, int y) {
  const FlatTriangle t = flat(mesh, chart, triangle);
  const Vector3f weights = nearest_weights(t, centre(x, y));
  const Vector2f beside = centre(x, y) - point_of(t, weights);
  ChartPoint point;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::uint32_t corner = mesh.triangles[triangle][i];
    const float weight = weights[static_cast<Eigen::Index>(i)];
    const Rgb8& color = mesh.colors[corner];
    point.position_m += weight * mesh.positions_m[corner];
    point.normal += weight * mesh.normals[corner];
    point.color += weight * Vector3f(color.r, color.g, color.b);
  }
  // Rows are orthogonal directions divided by the texel size.
  point.position_m +=
      chart.texel_m * chart.texel_m * (chart.texels_from_world.transpose() * beside);
  const float length = point.normal.norm();
  if (length > 0) point.normal /= length;
  return point;
}

}  // namespace hermite::texture
