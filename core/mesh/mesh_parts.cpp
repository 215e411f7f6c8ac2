#include "core/mesh/mesh_parts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/base/disjoint_sets.h"

namespace hermite {
namespace {

// A corner of a triangle, numbered 3 * triangle + corner; its edge runs to the next corner.
struct EdgeUse {
  std::uint32_t low = 0, high = 0;  // vertices
  std::uint32_t corner = 0;
  bool operator<(const EdgeUse& other) const { return std::tie(low, high, corner) < std::tie(other.low, other.high, other.corner); }
};

std::uint32_t next_corner(std::uint32_t corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

std::vector<EdgeUse> edge_uses(const TriangleMesh& mesh) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * mesh.triangles.size());
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t a = mesh.triangles[i][k], b = mesh.triangles[i][(k + 1) % 3];
      uses.push_back({std::min(a, b), std::max(a, b), 3 * i + k});
    }
  std::sort(uses.begin(), uses.end());
  return uses;
}

// A fold is a cell or two wide: what twenty steps do not take out of it will not go.
constexpr int kMostUnfoldings = 20;

bool is_folded(const TriangleMesh& mesh, const TriangleCorners& triangle) {
  const auto& [a, b, c] = triangle;
  const Eigen::Vector3f across = (mesh.positions_m[b] - mesh.positions_m[a]).cross(mesh.positions_m[c] - mesh.positions_m[a]);
  return !(across.dot(mesh.normals[a] + mesh.normals[b] + mesh.normals[c]) > 0);
}

// Moves these vertices half-way to the middle of those that they have edges to, since all the way neighbours would pass each other, and
// turns their normals alike.
void relax(TriangleMesh& mesh, const std::vector<bool>& is_moving) {
  struct Around {
    Eigen::Vector3f positions_m = Eigen::Vector3f::Zero(), normals = Eigen::Vector3f::Zero();
    float count = 0;
  };
  std::unordered_map<std::uint32_t, Around> around;
  for (const TriangleCorners& triangle : mesh.triangles)
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

}  // namespace

double area_m2(const TriangleMesh& mesh, const TriangleCorners& triangle) {
  const Eigen::Vector3d a = mesh.positions_m[triangle[0]].cast<double>();
  return 0.5 * (mesh.positions_m[triangle[1]].cast<double>() - a).cross(mesh.positions_m[triangle[2]].cast<double>() - a).norm();
}

std::size_t remove_small_parts(TriangleMesh& mesh, double least_part_m2) {
  DisjointSets parts(mesh.positions_m.size());
  for (const auto& [a, b, c] : mesh.triangles) {
    parts.join(a, b);
    parts.join(a, c);
  }
  std::vector<double> areas_m2(mesh.positions_m.size());
  std::vector<bool> is_there(mesh.positions_m.size());
  for (const TriangleCorners& triangle : mesh.triangles) {
    areas_m2[parts.root(triangle[0])] += area_m2(mesh, triangle);
    is_there[parts.root(triangle[0])] = true;
  }
  const auto is_small = [&](const TriangleCorners& triangle) { return areas_m2[parts.root(triangle[0])] < least_part_m2; };
  mesh.triangles.erase(std::remove_if(mesh.triangles.begin(), mesh.triangles.end(), is_small), mesh.triangles.end());
  remove_unused_vertices(mesh);
  std::size_t count = 0;
  for (std::size_t i = 0; i < areas_m2.size(); ++i) count += is_there[i] && areas_m2[i] < least_part_m2 ? 1 : 0;
  return count;
}

void remove_unused_vertices(TriangleMesh& mesh) {
  std::vector<bool> is_used(mesh.positions_m.size());
  for (const TriangleCorners& triangle : mesh.triangles)
    for (const std::uint32_t vertex : triangle) is_used[vertex] = true;
  std::vector<std::uint32_t> place(is_used.size());
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < is_used.size(); ++i) {
    if (!is_used[i]) continue;
    mesh.positions_m[count] = mesh.positions_m[i];
    mesh.normals[count] = mesh.normals[i];
    mesh.colors[count] = mesh.colors[i];
    place[i] = count++;
  }
  mesh.positions_m.resize(count);
  mesh.normals.resize(count);
  mesh.colors.resize(count);
  for (TriangleCorners& triangle : mesh.triangles)
    for (std::uint32_t& vertex : triangle) vertex = place[vertex];
}

std::size_t unfold(TriangleMesh& mesh) {
  for (int step = 0; step < kMostUnfoldings; ++step) {
    std::vector<bool> is_moving(mesh.positions_m.size());
    bool is_any = false;
    for (const TriangleCorners& triangle : mesh.triangles) {
      if (!is_folded(mesh, triangle)) continue;
      is_any = true;
      for (const std::uint32_t vertex : triangle) is_moving[vertex] = true;
    }
    if (!is_any) return 0;
    relax(mesh, is_moving);
  }
  const std::size_t count = mesh.triangles.size();
  std::erase_if(mesh.triangles, [&mesh](const TriangleCorners& triangle) { return is_folded(mesh, triangle); });
  return count - mesh.triangles.size();
}

std::size_t split_touching_fans(TriangleMesh& mesh) {
  DisjointSets fans(3 * mesh.triangles.size());  // of corners, each at one vertex
  const std::vector<EdgeUse> uses = edge_uses(mesh);
  for (std::size_t first = 0, last; first < uses.size(); first = last) {
    for (last = first; last < uses.size() && uses[last].low == uses[first].low && uses[last].high == uses[first].high;) ++last;
    if (last - first != 2) continue;
    const std::uint32_t a = uses[first].corner, b = uses[first + 1].corner;
    const auto vertex = [&mesh](std::uint32_t corner) { return mesh.triangles[corner / 3][corner % 3]; };
    if (vertex(a) == vertex(b)) continue;  // both run the same way round: two surfaces, back to back
    fans.join(a, next_corner(b));
    fans.join(next_corner(a), b);
  }
  constexpr std::uint32_t kNone = ~0u;
  std::vector<std::uint32_t> fan_of_vertex(mesh.positions_m.size(), kNone), vertex_of_fan(3 * mesh.triangles.size(), kNone);
  std::size_t added = 0;
  for (std::uint32_t corner = 0; corner < 3 * mesh.triangles.size(); ++corner) {
    std::uint32_t& vertex = mesh.triangles[corner / 3][corner % 3];
    const std::uint32_t fan = fans.root(corner);
    if (vertex_of_fan[fan] == kNone) {
      vertex_of_fan[fan] = vertex;
      if (fan_of_vertex[vertex] == kNone) {
        fan_of_vertex[vertex] = fan;
      } else {
        vertex_of_fan[fan] = static_cast<std::uint32_t>(mesh.positions_m.size());
        mesh.positions_m.push_back(Eigen::Vector3f(mesh.positions_m[vertex]));
        mesh.normals.push_back(Eigen::Vector3f(mesh.normals[vertex]));
        mesh.colors.push_back(Rgb8(mesh.colors[vertex]));
        ++added;
      }
    }
    vertex = vertex_of_fan[fan];
  }
  return added;
}

}  // namespace hermite
