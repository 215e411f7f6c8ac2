#include "core/evaluate/mesh_error.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/parallel.h"
#include "core/evaluate/drawn_depth.h"
#include "core/evaluate/true_surface.h"

namespace hermite::evaluate {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kAtOnce = 4096;
// A sample of the truth that is farther from the mesh counts as missing.
constexpr double kMissing_m = 0.010;

double area_m2(const Triangle& t) {
  const double area = 0.5 * static_cast<double>((t[1] - t[0]).cross(t[2] - t[0]).norm());
  return std::isfinite(area) ? area : 0;
}

bool is_dot(const Triangle& t) { return t[0] == t[1] && t[1] == t[2]; }

std::vector<double> distances_of(const std::vector<Vector3d>& points,
                                 const std::function<double(const Vector3d&)>& distance_m) {
  std::vector<double> distances_m(points.size());
  in_parallel(points.size() / kAtOnce + 1, [&](std::size_t piece) {
    for (std::size_t i = piece * kAtOnce; i < std::min((piece + 1) * kAtOnce, points.size()); ++i)
      distances_m[i] = distance_m(points[i]);
  });
  return distances_m;
}

double share_within(const std::vector<double>& distances_m, double within_m) {
  if (distances_m.empty()) return 0;
  const auto is_within = [&](double distance_m) { return distance_m <= within_m; };
  return static_cast<double>(std::count_if(distances_m.begin(), distances_m.end(), is_within)) /
         static_cast<double>(distances_m.size());
}

// Absolute differences of depth.
struct DepthDifferences {
  std::vector<float> both_m;
  std::int64_t missing = 0;
};

DepthDifferences differences_of(const std::vector<Triangle>& triangles, const Camera& camera,
                                const BesideView& view) {
  DepthDifferences differences;
  const Image<float> drawn_m = drawn_depth_m(triangles, camera, view.world_from_camera);
  for (std::size_t i = 0; i < drawn_m.pixels.size(); ++i) {
    if (view.depth_m.pixels[i] == 0) continue;
    if (drawn_m.pixels[i] == 0)
      ++differences.missing;
    else
      differences.both_m.push_back(std::abs(drawn_m.pixels[i] - view.depth_m.pixels[i]));
  }
  return differences;
}

void judge_depth(const std::vector<Triangle>& triangles, const SeenTruth& truth, MeshError& error) {
  std::vector<DepthDifferences> by_view(truth.views.size());
  in_parallel(by_view.size(), [&](std::size_t i) {
    by_view[i] = differences_of(triangles, truth.view_camera, truth.views[i]);
  });
  DepthDifferences differences;
  for (const DepthDifferences& of_view : by_view) {
    differences.missing += of_view.missing;
    differences.both_m.insert(differences.both_m.end(), of_view.both_m.begin(),
                              of_view.both_m.end());
  }
  error.views = static_cast<std::int64_t>(truth.views.size());
  std::vector<float>& both_m = differences.both_m;
  const auto count = static_cast<double>(both_m.size());
  if (const double all = count + static_cast<double>(differences.missing); all > 0)
    error.depth_missing = static_cast<double>(differences.missing) / all;
  if (both_m.empty()) return;
  for (const float difference : both_m) {
    error.depth_mean_m += static_cast<double>(difference) / count;
    error.depth_capped_mean_m += std::min(static_cast<double>(difference), kSurfaceReach_m) / count;
  }
  const auto middle = both_m.begin() + static_cast<std::ptrdiff_t>(both_m.size() / 2);
  std::nth_element(both_m.begin(), middle, both_m.end());
  error.depth_median_m = static_cast<double>(*middle);
}

TriangleSurface dots_of(const std::vector<Vector3d>& points, double reach_m) {
  std::vector<Triangle> dots;
  dots.reserve(points.size());
  for (const Vector3d& point : points) {
    const Eigen::Vector3f dot = point.cast<float>();
    dots.push_back({dot, dot, dot});
  }
  return {dots, reach_m};
}

}  // namespace

std::vector<Vector3d> points_on(const std::vector<Triangle>& triangles, std::size_t count) {
  double total_m2 = 0;
  for (const Triangle& triangle : triangles) total_m2 += area_m2(triangle);
  std::vector<Vector3d> points;
  if (!(total_m2 > 0)) return points;
  points.reserve(count);
  double passed_m2 = 0;
  for (const Triangle& triangle : triangles) {
    passed_m2 += area_m2(triangle);
    while (points.size() < count &&
           (static_cast<double>(points.size()) + 0.5) / static_cast<double>(count) * total_m2 <
               passed_m2) {
      // The additive sequence of the plastic number fills a square evenly; the half beyond the
      // diagonal is folded back.
      const auto i = static_cast<double>(points.size());
      double u = std::fmod(0.5 + 0.7548776662466927 * i, 1.0),
             v = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      points.push_back((1 - u - v) * triangle[0].cast<double>() + u * triangle[1].cast<double>() +
                       v * triangle[2].cast<double>());
    }
  }
  return points;
}

Result<MeshError> mesh_error(const std::vector<Triangle>& triangles, const SeenTruth& truth,
                             std::size_t point_count) {
  const bool is_cloud = std::all_of(triangles.begin(), triangles.end(), is_dot);
  std::vector<Vector3d> points;
  if (is_cloud)
    for (const Triangle& dot : triangles) points.push_back(dot[0].cast<double>());
  else
    points = points_on(triangles, point_count);
  if (points.empty()) return Error{ErrorCode::kInvalidArgument, "a mesh without area has no error"};
  if (!std::all_of(points.begin(), points.end(),
                   [](const Vector3d& point) { return point.allFinite(); }))
    return Error{ErrorCode::kInvalidArgument, "a point of what is judged is not finite"};
  const TriangleSurface creases = dots_of(truth.creases, kCreaseWidth_m * 1.01);
  const auto is_at_crease = [&](const Vector3d& point) {
    return creases.distance_m(point) <= kCreaseWidth_m;
  };
  const std::vector<double> to_truth_m = distances_of(points, truth.distance_m);
  std::vector<double> to_truth_at_creases_m;
  for (std::size_t i = 0; i < points.size(); ++i)
    if (is_at_crease(points[i])) to_truth_at_creases_m.push_back(to_truth_m[i]);

  const TriangleSurface mesh(triangles, kMissing_m * 1.01);
  const std::vector<double> to_mesh_m =
      distances_of(truth.samples, [&](const Vector3d& point) { return mesh.distance_m(point); });
  std::vector<double> to_mesh_at_creases_m;
  for (std::size_t i = 0; i < truth.samples.size(); ++i)
    if (is_at_crease(truth.samples[i])) to_mesh_at_creases_m.push_back(to_mesh_m[i]);

  MeshError error;
  error.at_5mm = {0.005, share_within(to_truth_m, 0.005), share_within(to_mesh_m, 0.005)};
  error.at_10mm = {kMissing_m, share_within(to_truth_m, kMissing_m),
                   share_within(to_mesh_m, kMissing_m)};
  if (!to_mesh_at_creases_m.empty())
    error.missing_at_creases = 1 - share_within(to_mesh_at_creases_m, kMissing_m);
  const Result<SurfaceError> all = surface_error(to_truth_m);
  if (!all.ok()) return all.error();
  error.surface = *all;
  if (!to_truth_at_creases_m.empty())
    error.creases = *surface_error(std::move(to_truth_at_creases_m));
  if (!is_cloud) judge_depth(triangles, truth, error);
  return error;
}

std::string format_mesh_error_json(const MeshError& error) {
  nlohmann::ordered_json json =
      nlohmann::ordered_json::parse(format_surface_error_json(error.surface));
  if (error.creases) {
    json["edge_points"] = error.creases->point_count;
    json["edge_mean_m"] = error.creases->mean_m;
    json["edge_median_m"] = error.creases->median_m;
    json["edge_percentile95_m"] = error.creases->percentile95_m;
  }
  json["edge_missing_10mm"] = error.missing_at_creases;
  for (const auto& [score, name] :
       {std::pair(&error.at_5mm, "5mm"), std::pair(&error.at_10mm, "10mm")}) {
    json[std::string("precision_") + name] = score->precision;
    json[std::string("recall_") + name] = score->recall;
    json[std::string("f_score_") + name] = score->f();
  }
  json["depth_views"] = error.views;
  json["depth_mean_m"] = error.depth_mean_m;
  json["depth_capped_mean_m"] = error.depth_capped_mean_m;
  json["depth_median_m"] = error.depth_median_m;
  json["depth_missing"] = error.depth_missing;
  return json.dump(2) + "\n";
}

}  // namespace hermite::evaluate
