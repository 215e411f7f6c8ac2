#include "core/mesh/border_loops.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <numbers>

#include "core/base/disjoint_sets.h"

namespace hermite::mesh {
namespace {

constexpr std::uint32_t kNoVertex = std::numeric_limits<std::uint32_t>::max();
// The cosine between the loop's area vector and the mean surface normal: 1 in a plane, 0.6 around
// the corner of a room, 0 at the end of a tube.
constexpr double kLeastFacing = 0.4;
// A slit has too little area to have a direction. As a fraction of the area of a circle of equal
// perimeter.
constexpr double kSlit = 0.01;

Eigen::Vector3f face_normal(const output::TriangleMesh& mesh, std::uint32_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const Eigen::Vector3f across =
      (mesh.positions_m[b] - mesh.positions_m[a]).cross(mesh.positions_m[c] - mesh.positions_m[a]);
  const float length = across.norm();
  return length > 0 ? Eigen::Vector3f(across / length) : Eigen::Vector3f(Eigen::Vector3f::Zero());
}

// A step along a boundary to its next vertex, with the surface on the right.
struct BorderStep {
  std::uint32_t to = kNoVertex;
  std::uint32_t triangle = 0;
  int begun = 0, ended = 0;  // boundary edges that begin and end at this vertex
  // An edge here has more than two triangles, or two that traverse it in the same direction.
  bool is_odd = false;
};

class BorderSteps {
 public:
  BorderSteps(const output::TriangleMesh& mesh, const VertexCorners& corners)
      : steps_(mesh.positions_m.size()) {
    for (std::uint32_t vertex = 0; vertex < steps_.size(); ++vertex)
      for (const std::uint32_t corner : corners.at(vertex)) look_at(mesh, corners, vertex, corner);
  }
  const std::vector<BorderStep>& steps() const { return steps_; }

 private:
  // Examines the edge that starts at this corner.
  void look_at(const output::TriangleMesh& mesh, const VertexCorners& corners, std::uint32_t from,
               std::uint32_t corner) {
    const std::uint32_t to = vertex_at(mesh, next_corner(corner));
    int along = 0, against = 0;
    for (const std::uint32_t other : corners.at(from)) {
      along += vertex_at(mesh, next_corner(other)) == to ? 1 : 0;
      against += vertex_at(mesh, previous_corner(other)) == to ? 1 : 0;
    }
    if (along > 1 || against > 1) steps_[from].is_odd = steps_[to].is_odd = true;
    if (against > 0) return;
    // A filling triangle traverses the edge in the opposite direction to the surface.
    steps_[to].to = from;
    steps_[to].triangle = corner / 3;
    ++steps_[to].begun;
    ++steps_[from].ended;
  }

  std::vector<BorderStep> steps_;  // by vertex
};

}  // namespace

Borders borders_of(const output::TriangleMesh& mesh, const VertexCorners& corners) {
  const BorderSteps found(mesh, corners);
  const std::vector<BorderStep>& steps = found.steps();
  DisjointSets borders(steps.size());
  for (std::uint32_t vertex = 0; vertex < steps.size(); ++vertex)
    if (steps[vertex].begun > 0) borders.join(vertex, steps[vertex].to);
  std::vector<bool> is_tangled(steps.size()), is_border(steps.size());
  for (std::uint32_t vertex = 0; vertex < steps.size(); ++vertex) {
    const BorderStep& step = steps[vertex];
    const bool is_simple = step.begun == 1 && step.ended == 1 && !step.is_odd;
    if (step.begun + step.ended == 0) continue;
    is_border[borders.root(vertex)] = true;
    if (!is_simple) is_tangled[borders.root(vertex)] = true;
  }
  Borders result;
  for (std::uint32_t root = 0; root < steps.size(); ++root) {
    if (!is_border[root]) continue;
    BorderLoop loop;
    std::uint32_t vertex = root;
    do {
      if (is_tangled[root]) break;
      loop.vertices.push_back(vertex);
      loop.face_normals.push_back(face_normal(mesh, steps[vertex].triangle));
      vertex = steps[vertex].to;
    } while (vertex != root);
    if (loop.vertices.size() < 3)
      ++result.tangled;
    else
      result.loops.push_back(std::move(loop));
  }
  return result;
}

bool is_wider(const output::TriangleMesh& mesh, const BorderLoop& loop, double width_m) {
  Eigen::Vector3f low = mesh.positions_m[loop.vertices.front()], high = low;
  for (const std::uint32_t vertex : loop.vertices) {
    low = low.cwiseMin(mesh.positions_m[vertex]);
    high = high.cwiseMax(mesh.positions_m[vertex]);
  }
  const auto width = static_cast<float>(width_m);
  if ((high - low).maxCoeff() > width) return true;
  if ((high - low).norm() <= width) return false;
  for (std::size_t i = 0; i < loop.vertices.size(); ++i)
    for (std::size_t k = i + 1; k < loop.vertices.size(); ++k)
      if ((mesh.positions_m[loop.vertices[i]] - mesh.positions_m[loop.vertices[k]]).squaredNorm() >
          width * width)
        return true;
  return false;
}

bool is_hole(const output::TriangleMesh& mesh, const BorderLoop& loop) {
  const Eigen::Vector3d origin_m = mesh.positions_m[loop.vertices.front()].cast<double>();
  Eigen::Vector3d twice_area = Eigen::Vector3d::Zero(), normals = Eigen::Vector3d::Zero();
  double length_m = 0;
  for (std::size_t i = 0; i < loop.vertices.size(); ++i) {
    const Eigen::Vector3d a = mesh.positions_m[loop.vertices[i]].cast<double>() - origin_m;
    const Eigen::Vector3d b =
        mesh.positions_m[loop.vertices[(i + 1) % loop.vertices.size()]].cast<double>() - origin_m;
    const double edge_m = (b - a).norm();
    twice_area += a.cross(b);
    normals += edge_m * loop.face_normals[i].cast<double>();
    length_m += edge_m;
  }
  const double area_m2 = 0.5 * twice_area.norm();
  if (!(area_m2 > kSlit * length_m * length_m / (4 * std::numbers::pi))) return true;
  return 0.5 * twice_area.dot(normals) > kLeastFacing * area_m2 * length_m;
}

}  // namespace hermite::mesh
