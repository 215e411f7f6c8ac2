#include "core/mesh/hole_fill.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <optional>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include "core/base/parallel.h"
#include "core/mesh/border_loops.h"
#include "core/mesh/loop_triangulation.h"
#include "core/mesh/patch_fairing.h"
#include "core/mesh/patch_refinement.h"
#include "core/mesh/vertex_corners.h"
#include "core/output/mesh_check.h"

namespace hermite::mesh {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;

// The largest distance of a patch from the middle of its boundary, relative to that of the
// boundary. A patch that reaches farther continues a surface that is too rough to measure its
// curvature.
constexpr double kMostReach = 1.2;

// The filling of one hole. Its triangles index the points of the loop first, then the inner points.
struct Filling {
  Patch patch;
  std::vector<Eigen::Vector3f> normals;  // of all points
  std::vector<Rgb8> colors;
  double area_m2 = 0;
};

Vector3d across(const Patch& patch, const output::TriangleCorners& t) {
  const auto& p = patch.points_m;
  return (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
}

class HoleFiller {
 public:
  HoleFiller(const output::TriangleMesh& mesh, const VertexCorners& corners, const BorderLoop& loop)
      : mesh_(mesh), corners_(corners), loop_(loop) {}

  // Returns a filling that continues the curvature around the hole, or a flatter one where that
  // would fold; std::nullopt if every attempt folds or existing edges prevent it.
  std::optional<Filling> bent();
  // Returns a minimal surface across the boundary; std::nullopt if existing edges prevent it.
  std::optional<Filling> stretched();

 private:
  bool is_taken(std::size_t i, std::size_t k) const;
  std::optional<Patch> flat() const;
  PatchSurroundings surroundings() const;
  bool reaches_too_far(const Patch& patch) const;
  void stretch(Patch& patch) const;
  std::optional<Filling> finished(Patch patch) const;
  bool is_folded(const Filling& filling) const;
  void mean_border_normals(Filling& filling) const;

  const output::TriangleMesh& mesh_;
  const VertexCorners& corners_;
  const BorderLoop& loop_;
};

bool HoleFiller::is_taken(std::size_t i, std::size_t k) const {
  const std::uint32_t other = loop_.vertices[k];
  const std::span<const std::uint32_t> here = corners_.at(loop_.vertices[i]);
  return std::any_of(here.begin(), here.end(), [&](std::uint32_t corner) {
    return vertex_at(mesh_, next_corner(corner)) == other ||
           vertex_at(mesh_, previous_corner(corner)) == other;
  });
}

std::optional<Patch> HoleFiller::flat() const {
  Patch patch;
  patch.border_count = loop_.vertices.size();
  std::vector<Vector3d> face_normals;
  for (std::size_t i = 0; i < patch.border_count; ++i) {
    patch.points_m.push_back(mesh_.positions_m[loop_.vertices[i]].cast<double>());
    face_normals.push_back(loop_.face_normals[i].cast<double>());
  }
  // If three points already have a triangle, the filling would be its back side.
  if (patch.border_count == 3 && corners_.at(loop_.vertices[0]).size() == 1) return std::nullopt;
  std::optional<std::vector<output::TriangleCorners>> triangles =
      triangulated({patch.points_m, face_normals,
                    [this](std::size_t i, std::size_t k) { return is_taken(i, k); }});
  if (!triangles) return std::nullopt;
  patch.triangles = *std::move(triangles);
  return patch;
}

// Returns all triangles at the vertices of the boundary; `points_m` are in the order in which they
// are found.
PatchSurroundings HoleFiller::surroundings() const {
  PatchSurroundings around;
  // By vertex, boundary first; only for look-up, never iterated.
  std::unordered_map<std::uint32_t, std::uint32_t> place;
  for (std::uint32_t i = 0; i < loop_.vertices.size(); ++i) place[loop_.vertices[i]] = i;
  for (std::uint32_t i = 0; i < loop_.vertices.size(); ++i)
    for (const std::uint32_t corner : corners_.at(loop_.vertices[i])) {
      output::TriangleCorners t{};
      std::uint32_t first = ~0u;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::uint32_t vertex = mesh_.triangles[corner / 3][k];
        const auto count =
            static_cast<std::uint32_t>(loop_.vertices.size() + around.points_m.size());
        const auto [found, is_new] = place.try_emplace(vertex, count);
        if (is_new) around.points_m.push_back(mesh_.positions_m[vertex].cast<double>());
        t[k] = found->second;
        if (t[k] < loop_.vertices.size()) first = std::min(first, t[k]);
      }
      // Added once, by the first of its boundary vertices.
      if (first == i) around.triangles.push_back(t);
    }
  return around;
}

bool HoleFiller::reaches_too_far(const Patch& patch) const {
  Vector3d middle_m = Vector3d::Zero();
  for (std::size_t i = 0; i < patch.border_count; ++i)
    middle_m += patch.points_m[i] / static_cast<double>(patch.border_count);
  double border_m = 0, inner_m = 0;
  for (std::size_t i = 0; i < patch.points_m.size(); ++i) {
    double& farthest_m = i < patch.border_count ? border_m : inner_m;
    farthest_m = std::max(farthest_m, (patch.points_m[i] - middle_m).norm());
  }
  return inner_m > kMostReach * border_m;
}

void HoleFiller::stretch(Patch& patch) const {
  MatrixXd border_m(static_cast<Eigen::Index>(patch.border_count), 3);
  for (std::size_t i = 0; i < patch.border_count; ++i)
    border_m.row(static_cast<Eigen::Index>(i)) = patch.points_m[i].transpose();
  const MatrixXd points_m = spread_from_border(patch, border_m);
  for (Eigen::Index i = 0; i < points_m.rows(); ++i)
    patch.points_m[static_cast<std::size_t>(i)] = points_m.row(i).transpose();
}

// Adds normals and colours.
std::optional<Filling> HoleFiller::finished(Patch patch) const {
  const std::size_t border = patch.border_count, count = patch.points_m.size();
  MatrixXd border_colors(static_cast<Eigen::Index>(border), 3);
  for (std::size_t i = 0; i < border; ++i) {
    const Rgb8 color = mesh_.colors[loop_.vertices[i]];
    border_colors.row(static_cast<Eigen::Index>(i)) << color.r, color.g, color.b;
  }
  const MatrixXd colors = spread_from_border(patch, border_colors);
  if (colors.rows() == 0) return std::nullopt;
  Filling filling;
  std::vector<Vector3d> normals(count, Vector3d::Zero());
  for (const output::TriangleCorners& t : patch.triangles) {
    const Vector3d twice_area = across(patch, t);
    filling.area_m2 += 0.5 * twice_area.norm();
    for (const std::uint32_t point : t) normals[point] += twice_area;
  }
  const auto byte = [](double value) {
    return static_cast<std::uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
  };
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::RowVector3d color = colors.row(static_cast<Eigen::Index>(i));
    filling.colors.push_back({byte(color[0]), byte(color[1]), byte(color[2])});
    const Vector3d normal = normals[i].stableNormalized();
    filling.normals.push_back(i < border            ? mesh_.normals[loop_.vertices[i]]
                              : normal.norm() > 0.5 ? Eigen::Vector3f(normal.cast<float>())
                                                    : mesh_.normals[loop_.vertices[0]]);
  }
  filling.patch = std::move(patch);
  return filling;
}

bool HoleFiller::is_folded(const Filling& filling) const {
  return std::any_of(filling.patch.triangles.begin(), filling.patch.triangles.end(),
                     [&](const output::TriangleCorners& t) {
                       const Eigen::Vector3f mean =
                           filling.normals[t[0]] + filling.normals[t[1]] + filling.normals[t[2]];
                       return !(across(filling.patch, t).dot(mean.cast<double>()) > 0);
                     });
}

std::optional<Filling> HoleFiller::bent() {
  const std::optional<Patch> coarse = flat();
  if (!coarse) return std::nullopt;
  Patch fine = *coarse;
  refine(fine, [this](std::size_t i, std::size_t k) { return is_taken(i, k); });
  PatchSurroundings around = surroundings();
  for (output::TriangleCorners& t : around.triangles)
    for (std::uint32_t& point : t)
      if (point >= fine.border_count)
        point += static_cast<std::uint32_t>(fine.points_m.size() - fine.border_count);
  Patch smooth = fine;
  std::vector<Patch> ways;
  if (bend_least(smooth, around) && !reaches_too_far(smooth)) ways.push_back(std::move(smooth));
  ways.push_back(fine);
  stretch(ways.back());
  ways.push_back(*coarse);
  for (Patch& way : ways)
    if (std::optional<Filling> filling = finished(std::move(way)); filling && !is_folded(*filling))
      return filling;
  return std::nullopt;
}

std::optional<Filling> HoleFiller::stretched() {
  std::optional<Patch> patch = flat();
  if (!patch) return std::nullopt;
  refine(*patch, [this](std::size_t i, std::size_t k) { return is_taken(i, k); });
  stretch(*patch);
  std::optional<Filling> filling = finished(*std::move(patch));
  if (filling && is_folded(*filling)) mean_border_normals(*filling);
  return filling;
}

// Sets border normals to the mean over the triangles around, of the filling and of the mesh.
void HoleFiller::mean_border_normals(Filling& filling) const {
  std::vector<Vector3d> sums(filling.patch.border_count, Vector3d::Zero());
  for (const output::TriangleCorners& t : filling.patch.triangles)
    for (const std::uint32_t point : t)
      if (point < sums.size()) sums[point] += across(filling.patch, t).stableNormalized();
  for (std::size_t i = 0; i < sums.size(); ++i) {
    for (const std::uint32_t corner : corners_.at(loop_.vertices[i])) {
      const auto& [a, b, c] = mesh_.triangles[corner / 3];
      const Eigen::Vector3f twice_area = (mesh_.positions_m[b] - mesh_.positions_m[a])
                                             .cross(mesh_.positions_m[c] - mesh_.positions_m[a]);
      sums[i] += twice_area.stableNormalized().cast<double>();
    }
    if (sums[i].norm() > 1e-3) filling.normals[i] = sums[i].normalized().cast<float>();
  }
}

void append(const BorderLoop& loop, const Filling& filling, output::TriangleMesh& mesh) {
  const std::size_t border = filling.patch.border_count;
  const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
  for (std::size_t i = 0; i < border; ++i) mesh.normals[loop.vertices[i]] = filling.normals[i];
  for (std::size_t i = border; i < filling.patch.points_m.size(); ++i) {
    mesh.positions_m.push_back(filling.patch.points_m[i].cast<float>());
    mesh.normals.push_back(filling.normals[i]);
    mesh.colors.push_back(filling.colors[i]);
  }
  for (output::TriangleCorners t : filling.patch.triangles) {
    for (std::uint32_t& point : t)
      point = point < border ? loop.vertices[point]
                             : first + (point - static_cast<std::uint32_t>(border));
    mesh.triangles.push_back(t);
  }
}

// Where a closing surface turns back along the existing one, the mean normal of a boundary vertex
// does not suit all triangles around it; it is turned towards those that it opposes.
void turn_border_normals(const std::vector<bool>& is_turning, output::TriangleMesh& mesh) {
  constexpr int kMostTurns = 50;
  constexpr float kTurn = 0.3f;
  bool is_any = true;
  for (int i = 0; i < kMostTurns && is_any; ++i) {
    is_any = false;
    for (const output::TriangleCorners& t : mesh.triangles) {
      if (!is_turning[t[0]] && !is_turning[t[1]] && !is_turning[t[2]]) continue;
      const auto& p = mesh.positions_m;
      const Eigen::Vector3f twice_area = (p[t[1]] - p[t[0]]).cross(p[t[2]] - p[t[0]]);
      if (twice_area.dot(mesh.normals[t[0]] + mesh.normals[t[1]] + mesh.normals[t[2]]) >= 0)
        continue;
      is_any = true;
      for (const std::uint32_t vertex : t)
        if (is_turning[vertex])
          mesh.normals[vertex] =
              (mesh.normals[vertex] + kTurn * twice_area.stableNormalized()).stableNormalized();
    }
  }
}

Status check_hole_fill(const output::TriangleMesh& mesh, const HoleFillOptions& options) {
  if (!(options.width_m >= 0 && options.width_m <= kMostHoleWidth_m))
    return Error{ErrorCode::kInvalidArgument, fmt::format("holes of {:f} m: expected 0 to {:f}",
                                                          options.width_m, kMostHoleWidth_m)};
  if (!mesh.pages.empty())
    return Error{
        ErrorCode::kInvalidArgument,
        "holes are filled before a mesh is textured: fillings would have no place in its texture"};
  if (!mesh.is_filled.empty())
    return Error{ErrorCode::kInvalidArgument, "holes of the mesh were filled already"};
  return output::check_mesh(mesh);
}

}  // namespace

Result<output::TriangleMesh> holes_filled(const output::TriangleMesh& mesh,
                                          const HoleFillOptions& options,
                                          const MeshProgress& progress,
                                          HoleFillStatistics* statistics) {
  if (const Status status = check_hole_fill(mesh, options); !status.ok()) return status.error();
  const VertexCorners corners(mesh);
  const Borders borders = borders_of(mesh, corners);
  std::vector<std::optional<Filling>> fillings(borders.loops.size());
  std::vector<std::uint8_t> is_narrow(borders.loops.size());
  ToldProgress told(progress, std::max<std::size_t>(borders.loops.size(), 1));
  in_parallel(borders.loops.size(), [&](std::size_t i) {
    if (told.stopped()) return;
    const BorderLoop& loop = borders.loops[i];
    is_narrow[i] = !is_wider(mesh, loop, options.width_m) && is_hole(mesh, loop) ? 1 : 0;
    HoleFiller filler(mesh, corners, loop);
    if (is_narrow[i] != 0) fillings[i] = filler.bent();
    if (options.closes_all && !fillings[i]) {
      fillings[i] = filler.stretched();
      is_narrow[i] = 0;
    }
    told.add_one();
  });
  if (told.stopped()) return Error{ErrorCode::kBusy, "filling holes was stopped"};
  output::TriangleMesh result = mesh;
  HoleFillStatistics counts;
  counts.not_fillable = borders.tangled;
  std::vector<bool> is_turning(mesh.positions_m.size(), false);
  for (std::size_t i = 0; i < fillings.size(); ++i) {
    if (!fillings[i]) {
      ++(is_narrow[i] != 0 || options.closes_all ? counts.not_fillable : counts.left_open);
      continue;
    }
    ++(is_narrow[i] != 0 ? counts.filled : counts.closed);
    (is_narrow[i] != 0 ? counts.filled_area_m2 : counts.closed_area_m2) += fillings[i]->area_m2;
    append(borders.loops[i], *fillings[i], result);
    is_turning.resize(result.positions_m.size(), is_narrow[i] == 0);
    if (is_narrow[i] == 0)
      for (const std::uint32_t vertex : borders.loops[i].vertices) is_turning[vertex] = true;
  }
  if (counts.closed > 0) turn_border_normals(is_turning, result);
  if (result.triangles.size() > mesh.triangles.size()) {
    result.is_filled.assign(mesh.triangles.size(), 0);
    result.is_filled.resize(result.triangles.size(), 1);
  }
  if (statistics) *statistics = counts;
  return result;
}

}  // namespace hermite::mesh
