#include "server/evaluate_shape.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/dataset/trajectory.h"
#include "core/evaluate/double_layers.h"
#include "core/evaluate/mesh_error.h"
#include "core/evaluate/mesh_validity.h"
#include "core/evaluate/trajectory_error.h"
#include "core/evaluate/true_surface.h"
#include "core/output/ply.h"
#include "core/source/open_sequence.h"
#include "server/evaluate_trajectory.h"
#include "server/ply_file.h"

namespace hermite::commands {

namespace {

using Json = nlohmann::ordered_json;

// Errors of this size and more are red; no error is blue.
constexpr double kReddest_m = 0.02;

std::vector<evaluate::Triangle> triangles_of(const output::PlyShape& shape) {
  std::vector<evaluate::Triangle> triangles;
  for (const auto& [a, b, c] : shape.triangles)
    triangles.push_back({shape.positions[a], shape.positions[b], shape.positions[c]});
  if (shape.triangles.empty())
    for (const Eigen::Vector3f& p : shape.positions) triangles.push_back({p, p, p});
  return triangles;
}

struct Truth {
  evaluate::TrueSurface surface;
  dataset::Trajectory groundtruth;  // for alignment
};

Truth open_truth(const ShapeJudging& judging) {
  Truth truth;
  if (std::filesystem::is_regular_file(judging.surface)) {
    truth.surface = evaluate::surface_of_triangles(triangles_of(read_ply_file(judging.surface)));
  } else {
    const std::unique_ptr<dataset::Sequence> sequence =
        or_throw(source::open_sequence(judging.surface));
    truth.surface = or_throw(evaluate::surface_of_sequence(*sequence, judging.surface));
    truth.groundtruth = sequence->groundtruth();
  }
  if (!judging.groundtruth.empty()) truth.groundtruth = read_groundtruth(judging.groundtruth);
  return truth;
}

// Maps an error to a colour from blue over green to red.
Rgb8 color_of(double error_m) {
  const double share = std::min(error_m / kReddest_m, 1.0), green = 1 - std::abs(2 * share - 1);
  const auto byte = [](double value) { return static_cast<std::uint8_t>(255 * value + 0.5); };
  return {byte(share), byte(green), byte(1 - share)};
}

void write_colored(const std::string& path, const std::vector<Eigen::Vector3d>& points,
                   const Rigid3& world_from_cloud, const evaluate::TrueSurface& surface) {
  output::Cloud cloud;
  for (const Eigen::Vector3d& point : points) {
    output::CloudPoint colored;
    colored.position_m = point.cast<float>();
    colored.color = color_of(surface.distance_m(world_from_cloud * point));
    cloud.push_back(colored);
  }
  or_throw(output::write_file_atomically(path, output::format_ply(cloud)));
}

Json json_of(const evaluate::MeshValidity& validity) {
  return {{"vertices", validity.vertices},
          {"triangles", validity.triangles},
          {"not_finite_vertices", validity.not_finite_vertices},
          {"wrong_indices", validity.wrong_indices},
          {"degenerate_faces", validity.degenerate_faces},
          {"repeated_faces", validity.repeated_faces},
          {"overfull_edges", validity.overfull_edges},
          {"border_edges", validity.border_edges},
          {"disagreeing_edges", validity.disagreeing_edges},
          {"flipped_faces", validity.flipped_faces},
          {"pinched_vertices", validity.pinched_vertices},
          {"loose_vertices", validity.loose_vertices},
          {"components", validity.components},
          {"largest_component", validity.largest_component},
          {"area_m2", validity.area_m2}};
}

std::vector<evaluate::Triangle> moved(std::vector<evaluate::Triangle> triangles,
                                      const Rigid3& world_from_mesh) {
  for (evaluate::Triangle& triangle : triangles)
    for (Eigen::Vector3f& corner : triangle)
      corner = (world_from_mesh * corner.cast<double>()).cast<float>();
  return triangles;
}

Json judge_mesh(const std::string& path, const output::PlyShape& surfels,
                const ShapeJudging& judging, const Rigid3& world_from_mesh,
                const evaluate::SeenTruth* truth) {
  const output::PlyShape shape = read_ply_file(path);
  if (shape.triangles.empty())
    throw SetupError({ErrorCode::kInvalidArgument, path + " has no faces: it is no mesh"});
  output::TriangleMesh mesh;
  mesh.positions_m = shape.positions;
  mesh.normals = shape.normals;
  mesh.triangles = shape.triangles;
  Json json = {{"file", path}};
  json.update(json_of(evaluate::mesh_validity(mesh)));
  if (!surfels.positions.empty())
    json["vertices_away"] =
        evaluate::vertices_away_from(surfels.positions, mesh, 2 * judging.cell_m);
  if (truth)
    json.update(Json::parse(evaluate::format_mesh_error_json(
        or_throw(evaluate::mesh_error(moved(triangles_of(shape), world_from_mesh), *truth)))));
  return json;
}

}  // namespace

Json evaluate_surface(const ShapeJudging& judging) {
  const Truth truth = open_truth(judging);
  Rigid3 world_from_cloud;
  if (!judging.estimate.empty())
    world_from_cloud =
        or_throw(evaluate::trajectory_error(
                     or_throw(dataset::read_tum_trajectory(judging.estimate)), truth.groundtruth))
            .groundtruth_from_estimate;
  std::vector<Eigen::Vector3d> points;
  std::vector<evaluate::Triangle> in_world;
  for (const Eigen::Vector3f& position : read_ply_file(judging.cloud).positions) {
    points.push_back(position.cast<double>());
    const Eigen::Vector3f moved = (world_from_cloud * points.back()).cast<float>();
    in_world.push_back({moved, moved, moved});
  }
  Json json = Json::parse(evaluate::format_surface_error_json(
      or_throw(evaluate::surface_error(points, world_from_cloud, truth.surface.distance_m))));
  const evaluate::TriangleSurface cloud(in_world, evaluate::kSurfaceReach_m);
  json["completeness_5mm"] = evaluate::completeness(truth.surface, cloud, 0.005);
  json["completeness_10mm"] = evaluate::completeness(truth.surface, cloud, 0.010);
  if (!judging.colored.empty())
    write_colored(judging.colored, points, world_from_cloud, truth.surface);
  return json;
}

Json evaluate_meshes(const ShapeJudging& judging) {
  const output::PlyShape cloud =
      judging.cloud.empty() ? output::PlyShape() : read_ply_file(judging.cloud);
  const output::PlyShape surfels = judging.surfels.empty() ? cloud : read_ply_file(judging.surfels);
  std::optional<evaluate::SeenTruth> truth;
  Rigid3 world_from_mesh;
  if (!judging.surface.empty()) {
    const std::unique_ptr<dataset::Sequence> sequence =
        or_throw(source::open_sequence(judging.surface));
    truth = or_throw(evaluate::seen_truth(*sequence, judging.surface));
    if (!judging.estimate.empty())
      world_from_mesh = or_throw(evaluate::trajectory_error(
                                     or_throw(dataset::read_tum_trajectory(judging.estimate)),
                                     sequence->groundtruth()))
                            .groundtruth_from_estimate;
  }
  Json json = {{"meshes", Json::array()}};
  if (truth)
    json["truth"] = {{"samples", truth->samples.size()},
                     {"creases", truth->creases.size()},
                     {"views", truth->views.size()}};
  if (truth && !cloud.positions.empty())
    json["cloud"] = Json::parse(evaluate::format_mesh_error_json(
        or_throw(evaluate::mesh_error(moved(triangles_of(cloud), world_from_mesh), *truth))));
  for (const std::string& path : judging.meshes)
    json["meshes"].push_back(
        judge_mesh(path, surfels, judging, world_from_mesh, truth ? &*truth : nullptr));
  return json;
}

Json evaluate_layers(const std::string& cloud) {
  const output::PlyShape shape = read_ply_file(cloud);
  if (shape.normals.size() != shape.positions.size() || shape.positions.empty())
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         cloud + " has no points with normals (nx, ny, nz): its layers cannot be told"});
  std::vector<evaluate::LayerPoint> points(shape.positions.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {shape.positions[i], shape.normals[i],
                 i < shape.radii.size() ? shape.radii[i] : 0.0f};
  return Json::parse(evaluate::format_double_layers_json(evaluate::double_layers(points)));
}

}  // namespace hermite::commands
