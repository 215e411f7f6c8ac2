#include "core/evaluate/mesh_validity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <tuple>
#include <unordered_map>

#include "core/base/disjoint_sets.h"
#include "core/evaluate/triangle_surface.h"

namespace hermite::evaluate {

namespace {

using Eigen::Vector3d;

constexpr double kLeastArea_m2 = 1e-9;

// A side of a face, as an edge from the lower to the higher vertex.
struct FaceSide {
  std::uint32_t low = 0, high = 0;
  std::uint32_t face = 0;
  bool forward = false;  // the face runs from low to high
  auto order() const { return std::tuple(low, high, face); }
};

std::vector<output::TriangleCorners> whole_triangles(const output::TriangleMesh& mesh) {
  std::vector<output::TriangleCorners> triangles;
  for (const output::TriangleCorners& corners : mesh.triangles)
    if (std::all_of(corners.begin(), corners.end(),
                    [&](std::uint32_t i) { return i < mesh.positions_m.size(); }))
      triangles.push_back(corners);
  return triangles;
}

bool has_equal_corners(const output::TriangleCorners& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

void judge_faces(const output::TriangleMesh& mesh,
                 const std::vector<output::TriangleCorners>& triangles, MeshValidity& validity) {
  for (const output::TriangleCorners& corners : triangles) {
    const auto position = [&](std::size_t i) -> Vector3d {
      return mesh.positions_m[corners[i]].cast<double>();
    };
    const Vector3d normal = (position(1) - position(0)).cross(position(2) - position(0));
    const double area_m2 = 0.5 * normal.norm();
    if (has_equal_corners(corners) || !(area_m2 >= kLeastArea_m2)) ++validity.degenerate_faces;
    if (area_m2 > 0) validity.area_m2 += area_m2;
    if (mesh.normals.size() != mesh.positions_m.size()) continue;
    Vector3d mean = Vector3d::Zero();
    for (const std::uint32_t i : corners) mean += mesh.normals[i].cast<double>();
    if (normal.dot(mean) < 0) ++validity.flipped_faces;
  }
  std::vector<output::TriangleCorners> sorted = triangles;
  for (output::TriangleCorners& corners : sorted) std::sort(corners.begin(), corners.end());
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 1; i < sorted.size(); ++i)
    validity.repeated_faces += sorted[i] == sorted[i - 1] ? 1 : 0;
}

std::vector<FaceSide> sides_of(const std::vector<output::TriangleCorners>& triangles) {
  std::vector<FaceSide> sides;
  for (std::uint32_t face = 0; face < triangles.size(); ++face) {
    const output::TriangleCorners& corners = triangles[face];
    if (has_equal_corners(corners)) continue;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [low, high] = std::minmax({corners[i], corners[(i + 1) % 3]});
      sides.push_back({low, high, face, corners[i] == low});
    }
  }
  std::sort(sides.begin(), sides.end(),
            [](const FaceSide& a, const FaceSide& b) { return a.order() < b.order(); });
  return sides;
}

// In `fans`, corner 3 f + i of face f and its neighbours across edges form one set.
void judge_edges(const std::vector<output::TriangleCorners>& triangles, MeshValidity& validity,
                 DisjointSets& fans) {
  const std::vector<FaceSide> sides = sides_of(triangles);
  const auto corner_at = [&](std::uint32_t face, std::uint32_t vertex) {
    const output::TriangleCorners& corners = triangles[face];
    return 3 * face + static_cast<std::uint32_t>(std::find(corners.begin(), corners.end(), vertex) -
                                                 corners.begin());
  };
  for (std::size_t first = 0, last = 0; first < sides.size(); first = last) {
    while (last < sides.size() && sides[last].low == sides[first].low &&
           sides[last].high == sides[first].high)
      ++last;
    if (last - first == 1) ++validity.border_edges;
    if (last - first > 2) ++validity.overfull_edges;
    if (last - first == 2 && sides[first].forward == sides[first + 1].forward)
      ++validity.disagreeing_edges;
    for (std::size_t i = first + 1; i < last; ++i)
      for (const std::uint32_t vertex : {sides[first].low, sides[first].high})
        fans.join(corner_at(sides[first].face, vertex), corner_at(sides[i].face, vertex));
  }
}

// Faces belong to one part if they share a vertex, and to one fan if they also share an edge there.
void judge_vertices(const output::TriangleMesh& mesh,
                    const std::vector<output::TriangleCorners>& triangles, DisjointSets& fans,
                    MeshValidity& validity) {
  std::vector<std::vector<std::uint32_t>> fans_at(mesh.positions_m.size());
  DisjointSets parts(mesh.positions_m.size());
  for (std::uint32_t face = 0; face < triangles.size(); ++face)
    for (std::uint32_t i = 0; i < 3; ++i) {
      if (!has_equal_corners(triangles[face]))
        fans_at[triangles[face][i]].push_back(fans.root(3 * face + i));
      parts.join(triangles[face][0], triangles[face][i]);
    }
  for (std::vector<std::uint32_t>& fans_here : fans_at) {
    std::sort(fans_here.begin(), fans_here.end());
    const auto distinct = std::unique(fans_here.begin(), fans_here.end()) - fans_here.begin();
    if (distinct == 0) ++validity.loose_vertices;
    if (distinct > 1) ++validity.pinched_vertices;
  }
  std::unordered_map<std::uint32_t, std::int64_t> sizes;
  for (const output::TriangleCorners& corners : triangles) ++sizes[parts.root(corners[0])];
  validity.components = static_cast<std::int64_t>(sizes.size());
  std::int64_t largest = 0;
  for (const auto& [root, size] : sizes) largest = std::max(largest, size);
  if (!triangles.empty())
    validity.largest_component =
        static_cast<double>(largest) / static_cast<double>(triangles.size());
}

}  // namespace

MeshValidity mesh_validity(const output::TriangleMesh& mesh) {
  MeshValidity validity;
  const std::vector<output::TriangleCorners> triangles = whole_triangles(mesh);
  validity.vertices = static_cast<std::int64_t>(mesh.positions_m.size());
  validity.triangles = static_cast<std::int64_t>(mesh.triangles.size());
  validity.wrong_indices = validity.triangles - static_cast<std::int64_t>(triangles.size());
  validity.not_finite_vertices =
      std::count_if(mesh.positions_m.begin(), mesh.positions_m.end(),
                    [](const Eigen::Vector3f& position) { return !position.allFinite(); });
  judge_faces(mesh, triangles, validity);
  DisjointSets fans(3 * triangles.size());
  judge_edges(triangles, validity, fans);
  judge_vertices(mesh, triangles, fans, validity);
  return validity;
}

std::int64_t vertices_away_from(const std::vector<Eigen::Vector3f>& points,
                                const output::TriangleMesh& mesh, double within_m) {
  std::vector<Triangle> dots;
  dots.reserve(points.size());
  for (const Eigen::Vector3f& point : points) dots.push_back({point, point, point});
  const TriangleSurface cloud(dots, 2 * within_m);
  return std::count_if(
      mesh.positions_m.begin(), mesh.positions_m.end(), [&](const Eigen::Vector3f& position) {
        return !(position.allFinite() && cloud.distance_m(position.cast<double>()) <= within_m);
      });
}

}  // namespace hermite::evaluate
