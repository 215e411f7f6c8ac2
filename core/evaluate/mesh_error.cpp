#include "core/evaluate/mesh_error.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/evaluate/drawn_depth.h"
#include "core/evaluate/true_surface.h"

namespace hermite {

namespace {

using Eigen::Vector3d;

constexpr std::size_t kPoints = 400'000;

double area_m2(const Triangle& t) {
  const double area = 0.5 * static_cast<double>((t[1] - t[0]).cross(t[2] - t[0]).norm());
  return std::isfinite(area) ? area : 0;
}

bool is_dot(const Triangle& t) { return t[0] == t[1] && t[1] == t[2]; }

double share_of(const std::vector<Vector3d>& points, const std::function<bool(const Vector3d&)>& is_so) {
  if (points.empty()) return 0;
  return static_cast<double>(std::count_if(points.begin(), points.end(), is_so)) / static_cast<double>(points.size());
}

// Of absolute differences of depth.
struct DepthDifferences {
  std::vector<float> both_m;
  std::int64_t missing = 0;
};

void compare_view(const std::vector<Triangle>& triangles, const Camera& camera, const BesideView& view, DepthDifferences& differences) {
  const Image<float> drawn_m = drawn_depth_m(triangles, camera, view.world_from_camera);
  for (std::size_t i = 0; i < drawn_m.pixels.size(); ++i) {
    if (view.depth_m.pixels[i] == 0) continue;
    if (drawn_m.pixels[i] == 0)
      ++differences.missing;
    else
      differences.both_m.push_back(std::abs(drawn_m.pixels[i] - view.depth_m.pixels[i]));
  }
}

void judge_depth(const std::vector<Triangle>& triangles, const SeenTruth& truth, MeshError& error) {
  DepthDifferences differences;
  for (const BesideView& view : truth.views) compare_view(triangles, truth.view_camera, view, differences);
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
    while (points.size() < count && (static_cast<double>(points.size()) + 0.5) / static_cast<double>(count) * total_m2 < passed_m2) {
      // The additive sequence of the plastic number fills a square evenly; its half beyond the diagonal is folded back.
      const auto i = static_cast<double>(points.size());
      double u = std::fmod(0.5 + 0.7548776662466927 * i, 1.0), v = std::fmod(0.5 + 0.5698402909980532 * i, 1.0);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      points.push_back((1 - u - v) * triangle[0].cast<double>() + u * triangle[1].cast<double>() + v * triangle[2].cast<double>());
    }
  }
  return points;
}

Result<MeshError> mesh_error(const std::vector<Triangle>& triangles, const SeenTruth& truth) {
  const bool is_cloud = std::all_of(triangles.begin(), triangles.end(), is_dot);
  std::vector<Vector3d> points;
  if (is_cloud)
    for (const Triangle& dot : triangles) points.push_back(dot[0].cast<double>());
  else
    points = points_on(triangles, kPoints);
  if (points.empty()) return Error{ErrorCode::kInvalidArgument, "a mesh without area has no error"};
  MeshError error;
  Result<SurfaceError> all = surface_error(points, Rigid3(), truth.distance_m);
  if (!all.ok()) return all.error();
  error.surface = *all;

  const TriangleSurface creases = dots_of(truth.creases, kCreaseWidth_m * 1.01);
  const auto is_at_crease = [&](const Vector3d& point) { return creases.distance_m(point) <= kCreaseWidth_m; };
  std::vector<Vector3d> at_creases;
  std::copy_if(points.begin(), points.end(), std::back_inserter(at_creases), is_at_crease);
  if (!at_creases.empty()) error.creases = *surface_error(at_creases, Rigid3(), truth.distance_m);

  const TriangleSurface mesh(triangles, kSurfaceReach_m);
  for (const auto& [score, within_m] : {std::pair(&error.at_5mm, 0.005), std::pair(&error.at_10mm, 0.010)}) {
    const auto is_near_mesh = [&, within = within_m](const Vector3d& point) { return mesh.distance_m(point) <= within; };
    *score = {within_m, share_of(points, [&, within = within_m](const Vector3d& point) { return truth.distance_m(point) <= within; }),
              share_of(truth.samples, is_near_mesh)};
  }
  std::vector<Vector3d> true_edges;
  std::copy_if(truth.samples.begin(), truth.samples.end(), std::back_inserter(true_edges), is_at_crease);
  error.missing_at_creases = share_of(true_edges, [&](const Vector3d& point) { return mesh.distance_m(point) > error.at_10mm.within_m; });
  if (!is_cloud) judge_depth(triangles, truth, error);
  return error;
}

std::string format_mesh_error_json(const MeshError& error) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(format_surface_error_json(error.surface));
  if (error.creases) {
    json["edge_points"] = error.creases->point_count;
    json["edge_mean_m"] = error.creases->mean_m;
    json["edge_median_m"] = error.creases->median_m;
    json["edge_percentile95_m"] = error.creases->percentile95_m;
  }
  json["edge_missing_10mm"] = error.missing_at_creases;
  for (const auto& [score, name] : {std::pair(&error.at_5mm, "5mm"), std::pair(&error.at_10mm, "10mm")}) {
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

}  // namespace hermite
