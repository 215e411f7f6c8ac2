#include "core/mesh/mesh_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/base/disjoint_sets.h"
#include "core/mesh/vertex_corners.h"

namespace hermite::mesh {
namespace {

// A fold is one or two cells wide; what twenty smoothing steps do not flatten will stay folded.
constexpr int kMostUnfoldings = 20;

bool is_folded(const output::TriangleMesh& mesh, const output::TriangleCorners& triangle) {
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3f across =
      (mesh.positions_m[b] - mesh.positions_m[a]).cross(mesh.positions_m[c] - mesh.positions_m[a]);
  return !(across.dot(mesh.normals[a] + mesh.normals[b] + mesh.normals[c]) > 0);
}

// Moves these vertices and their normals half-way to their neighbours' mean (Laplacian smoothing);
// with full steps neighbours would overshoot each other.
void relax(output::TriangleMesh& mesh, const std::vector<bool>& is_moving) {
  struct Around {
    Eigen::Vector3f positions_m = Eigen::Vector3f::Zero(), normals = Eigen::Vector3f::Zero();
    float count = 0;
  };
  std::unordered_map<std::uint32_t, Around> around;
  for (const output::TriangleCorners& triangle : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) {
      if (!is_moving[triangle[k]]) continue;
      Around& sums = around[triangle[k]];
      for (const std::uint32_t other : {triangle[(k + 1) % 3], triangle[(k + 2) % 3]}) {
        sums.positions_m += mesh.positions_m[other];
        sums.normals += mesh.normals[other];
        ++sums.count;
      }
    }
  for (const auto& [vertex, sums] : around) {
    mesh.positions_m[vertex] = 0.5f * (mesh.positions_m[vertex] + sums.positions_m / sums.count);
    const Eigen::Vector3f normal = mesh.normals[vertex] + sums.normals / sums.count;
    if (normal.squaredNorm() > 1e-6f) mesh.normals[vertex] = normal.normalized();
  }
}

// A corner whose fan gets its own copy of the vertex.
struct MovedCorner {
  std::uint32_t first_of_fan = 0, corner = 0;
  bool operator<(const MovedCorner& other) const {
    return std::tie(first_of_fan, corner) < std::tie(other.first_of_fan, other.corner);
  }
};

// Finds those of the corners at one vertex, in ascending order, that are not in the fan of the
// first. Two triangles are in one fan if they share an edge that no third triangle has and traverse
// it in opposite directions; otherwise they are two surfaces, back to back.
void find_other_fans(const output::TriangleMesh& mesh, std::span<const std::uint32_t> corners,
                     std::vector<MovedCorner>& moved) {
  constexpr std::uint32_t kNone = ~0u;
  DisjointSets fans(corners.size());
  for (std::uint32_t i = 0; i < corners.size(); ++i) {
    const std::uint32_t to = vertex_at(mesh, next_corner(corners[i]));
    std::uint32_t beyond = kNone, uses = 0;
    for (std::uint32_t k = 0; k < corners.size(); ++k) {
      uses += vertex_at(mesh, next_corner(corners[k])) == to ? 1 : 0;
      if (vertex_at(mesh, previous_corner(corners[k])) != to) continue;
      ++uses;
      beyond = k;
    }
    if (uses == 2 && beyond != kNone) fans.join(i, beyond);
  }
  for (std::uint32_t i = 0; i < corners.size(); ++i)
    if (fans.root(i) != 0) moved.push_back({corners[fans.root(i)], corners[i]});
}

}  // namespace

double area_m2(const output::TriangleMesh& mesh, const output::TriangleCorners& triangle) {
  const Eigen::Vector3d a = mesh.positions_m[triangle[0]].cast<double>();
  return 0.5 * (mesh.positions_m[triangle[1]].cast<double>() - a)
                   .cross(mesh.positions_m[triangle[2]].cast<double>() - a)
                   .norm();
}

std::size_t remove_small_parts(output::TriangleMesh& mesh, double least_part_m2) {
  DisjointSets parts(mesh.positions_m.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    parts.join(a, b);
    parts.join(a, c);
  }
  std::vector<double> areas_m2(mesh.positions_m.size());
  std::vector<bool> is_there(mesh.positions_m.size());
  for (const output::TriangleCorners& triangle : mesh.triangles) {
    areas_m2[parts.root(triangle[0])] += area_m2(mesh, triangle);
    is_there[parts.root(triangle[0])] = true;
  }
  const auto is_small = [&](const output::TriangleCorners& triangle) {
    return areas_m2[parts.root(triangle[0])] < least_part_m2;
  };
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), is_small),
                       mesh.triangles.end());
  remove_unused_vertices(mesh);
  std::size_t count = 0;
  for (std::size_t i = 0; i < areas_m2.size(); ++i)
    count += is_there[i] && areas_m2[i] < least_part_m2 ? 1 : 0;
  return count;
}

void remove_unused_vertices(output::TriangleMesh& mesh) {
  std::vector<bool> is_used(mesh.positions_m.size());
  for (const output::TriangleCorners& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) is_used[vertex] = true;
  const bool has_texture = !mesh.texture_coordinates.empty(),
             has_confidences = !mesh.confidence_eighths.empty();
  std::vector<std::uint32_t> place(is_used.size());
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i]) continue;
    mesh.positions_m[count] = mesh.positions_m[i];
    mesh.normals[count] = mesh.normals[i];
    mesh.colors[count] = mesh.colors[i];
    if (has_texture) mesh.texture_coordinates[count] = mesh.texture_coordinates[i];
    if (has_confidences) mesh.confidence_eighths[count] = mesh.confidence_eighths[i];
    place[i] = count++;
  }
  mesh.positions_m.resize(count);
  mesh.normals.resize(count);
  mesh.colors.resize(count);
  if (has_texture) mesh.texture_coordinates.resize(count);
  if (has_confidences) mesh.confidence_eighths.resize(count);
  for (output::TriangleCorners& triangle : mesh.triangles)
    for (std::uint32_t& vertex : triangle) vertex = place[vertex];
}

std::size_t unfold(output::TriangleMesh& mesh) {
  for (int step = 0; step < kMostUnfoldings; ++step) {
    std::vector<bool> is_moving(mesh.positions_m.size());
    bool is_any = false;
    for (const output::TriangleCorners& triangle : mesh.triangles) {
      if (!is_folded(mesh, triangle)) continue;
      is_any = true;
      for (const std::uint32_t vertex : triangle) is_moving[vertex] = true;
    }
    if (!is_any) return 0;
    relax(mesh, is_moving);
  }
  const std::size_t count = mesh.triangles.size();
  std::erase_if(mesh.triangles, [&mesh](const output::TriangleCorners& triangle) {
    return is_folded(mesh, triangle);
  });
  return count - mesh.triangles.size();
}

std::size_t split_touching_fans(output::TriangleMesh& mesh) {
  std::vector<MovedCorner> moved;
  {
    const VertexCorners corners(mesh);
    for (std::uint32_t vertex = 0; vertex < mesh.positions_m.size(); ++vertex)
      find_other_fans(mesh, corners.at(vertex), moved);
  }
  std::sort(moved.begin(), moved.end());
  const std::size_t before = mesh.positions_m.size();
  for (std::size_t i = 0; i < moved.size(); ++i) {
    std::uint32_t& vertex = mesh.triangles[moved[i].corner / 3][moved[i].corner % 3];
    if (i == 0 || moved[i].first_of_fan != moved[i - 1].first_of_fan) {
      mesh.positions_m.push_back(Eigen::Vector3f(mesh.positions_m[vertex]));
      mesh.normals.push_back(Eigen::Vector3f(mesh.normals[vertex]));
      mesh.colors.push_back(Rgb8(mesh.colors[vertex]));
    }
    vertex = static_cast<std::uint32_t>(mesh.positions_m.size() - 1);
  }
  return mesh.positions_m.size() - before;
}

}  // namespace hermite::mesh
