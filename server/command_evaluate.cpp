// hermite evaluate
#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/dataset/text_file.h"
#include "core/evaluate/depth_consistency.h"
#include "core/evaluate/double_layers.h"
#include "core/evaluate/mesh_error.h"
#include "core/evaluate/mesh_validity.h"
#include "core/evaluate/trajectory_error.h"
#include "core/evaluate/true_surface.h"
#include "core/output/ply.h"
#include "core/source/open_sequence.h"
#include "server/commands.h"
#include "server/evaluate_measure.h"
#include "server/evaluate_texture.h"
#include "server/ply_file.h"

namespace hermite::commands {

namespace {

using Json = nlohmann::ordered_json;

struct EvaluateArguments {
  std::string estimate, groundtruth, per_frame, consistency, cloud, surface, colored, surfels;
  std::vector<std::string> meshes;
  double cell_m = 0.01;
  bool layers = false;
  TextureJudging texture;
  MeasureJudging measure;
  std::vector<std::int64_t> spacings = evaluate::ConsistencyOptions().spacings;
};

// Errors of this size and more are red; no error is blue.
constexpr double kReddest_m = 0.02;

// Reads ground truth from a TUM file or a sequence.
dataset::Trajectory read_groundtruth(const std::string& source) {
  if (dataset::is_file(source)) return or_throw(dataset::read_tum_trajectory(source));
  Result<std::unique_ptr<dataset::Sequence>> sequence = source::open_sequence(source);
  if (!sequence.ok())
    throw SetupError(in_context("ground truth, no file of that name", sequence.error()));
  dataset::Trajectory groundtruth = (*sequence)->groundtruth();
  if (groundtruth.empty()) throw SetupError({ErrorCode::kNotFound, source + " has no true poses"});
  return groundtruth;
}

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

Truth open_truth(const EvaluateArguments& arguments) {
  Truth truth;
  if (std::filesystem::is_regular_file(arguments.surface)) {
    truth.surface = evaluate::surface_of_triangles(triangles_of(read_ply_file(arguments.surface)));
  } else {
    const std::unique_ptr<dataset::Sequence> sequence =
        or_throw(source::open_sequence(arguments.surface));
    truth.surface = or_throw(evaluate::surface_of_sequence(*sequence, arguments.surface));
    truth.groundtruth = sequence->groundtruth();
  }
  if (!arguments.groundtruth.empty()) truth.groundtruth = read_groundtruth(arguments.groundtruth);
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

Json evaluate_surface(const EvaluateArguments& arguments) {
  const Truth truth = open_truth(arguments);
  Rigid3 world_from_cloud;
  if (!arguments.estimate.empty())
    world_from_cloud =
        or_throw(evaluate::trajectory_error(
                     or_throw(dataset::read_tum_trajectory(arguments.estimate)), truth.groundtruth))
            .groundtruth_from_estimate;
  std::vector<Eigen::Vector3d> points;
  std::vector<evaluate::Triangle> in_world;
  for (const Eigen::Vector3f& position : read_ply_file(arguments.cloud).positions) {
    points.push_back(position.cast<double>());
    const Eigen::Vector3f moved = (world_from_cloud * points.back()).cast<float>();
    in_world.push_back({moved, moved, moved});
  }
  Json json = Json::parse(evaluate::format_surface_error_json(
      or_throw(evaluate::surface_error(points, world_from_cloud, truth.surface.distance_m))));
  const evaluate::TriangleSurface cloud(in_world, evaluate::kSurfaceReach_m);
  json["completeness_5mm"] = evaluate::completeness(truth.surface, cloud, 0.005);
  json["completeness_10mm"] = evaluate::completeness(truth.surface, cloud, 0.010);
  if (!arguments.colored.empty())
    write_colored(arguments.colored, points, world_from_cloud, truth.surface);
  return json;
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
                const EvaluateArguments& arguments, const Rigid3& world_from_mesh,
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
        evaluate::vertices_away_from(surfels.positions, mesh, 2 * arguments.cell_m);
  if (truth)
    json.update(Json::parse(evaluate::format_mesh_error_json(
        or_throw(evaluate::mesh_error(moved(triangles_of(shape), world_from_mesh), *truth)))));
  return json;
}

// Returns the defects of every mesh and, if there is ground truth, its distance from that; for the
// cloud the same errors.
Json evaluate_meshes(const EvaluateArguments& arguments) {
  const output::PlyShape cloud =
      arguments.cloud.empty() ? output::PlyShape() : read_ply_file(arguments.cloud);
  const output::PlyShape surfels =
      arguments.surfels.empty() ? cloud : read_ply_file(arguments.surfels);
  std::optional<evaluate::SeenTruth> truth;
  Rigid3 world_from_mesh;
  if (!arguments.surface.empty()) {
    const std::unique_ptr<dataset::Sequence> sequence =
        or_throw(source::open_sequence(arguments.surface));
    truth = or_throw(evaluate::seen_truth(*sequence, arguments.surface));
    if (!arguments.estimate.empty())
      world_from_mesh = or_throw(evaluate::trajectory_error(
                                     or_throw(dataset::read_tum_trajectory(arguments.estimate)),
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
  for (const std::string& path : arguments.meshes)
    json["meshes"].push_back(
        judge_mesh(path, surfels, arguments, world_from_mesh, truth ? &*truth : nullptr));
  return json;
}

Json evaluate_trajectory(const EvaluateArguments& arguments) {
  const dataset::Trajectory estimate = or_throw(dataset::read_tum_trajectory(arguments.estimate));
  const Result<evaluate::TrajectoryError> error =
      evaluate::trajectory_error(estimate, read_groundtruth(arguments.groundtruth));
  if (!error.ok()) throw SetupError({ErrorCode::kNotFound, error.error().message});
  if (!arguments.per_frame.empty())
    or_throw(output::write_file_atomically(arguments.per_frame,
                                           evaluate::format_frame_errors_csv(error->frames)));
  return Json::parse(evaluate::format_trajectory_error_json(*error));
}

Json evaluate_consistency(const EvaluateArguments& arguments) {
  const std::unique_ptr<dataset::Sequence> sequence =
      or_throw(source::open_sequence(arguments.consistency));
  std::vector<dataset::Trajectory> trajectories{
      or_throw(dataset::read_tum_trajectory(arguments.estimate))};
  std::vector<std::string> names{"estimate"};
  dataset::Trajectory groundtruth = arguments.groundtruth.empty()
                                        ? sequence->groundtruth()
                                        : read_groundtruth(arguments.groundtruth);
  if (!groundtruth.empty()) {
    trajectories.push_back(std::move(groundtruth));
    names.push_back("groundtruth");
  }
  evaluate::ConsistencyOptions options;
  options.spacings = arguments.spacings;
  return Json::parse(evaluate::format_consistency_json(
      or_throw(evaluate::depth_consistency(*sequence, trajectories, options)), names));
}

Json evaluate_layers(const EvaluateArguments& arguments) {
  const output::PlyShape shape = read_ply_file(arguments.cloud);
  if (shape.normals.size() != shape.positions.size() || shape.positions.empty())
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         arguments.cloud + " has no points with normals (nx, ny, nz): its layers cannot be told"});
  std::vector<evaluate::LayerPoint> points(shape.positions.size());
  for (std::size_t i = 0; i < points.size(); ++i)
    points[i] = {shape.positions[i], shape.normals[i],
                 i < shape.radii.size() ? shape.radii[i] : 0.0f};
  return Json::parse(evaluate::format_double_layers_json(evaluate::double_layers(points)));
}

Json judge_texture(const EvaluateArguments& arguments) {
  if (arguments.meshes.size() != 1)
    throw SetupError({ErrorCode::kInvalidArgument, "--texture judges one --mesh"});
  TextureJudging judging = arguments.texture;
  judging.mesh = arguments.meshes.front();
  judging.trajectory = arguments.estimate;
  return evaluate_texture(judging);
}

int run_evaluate(const EvaluateArguments& arguments) {
  Json json = Json::object();
  if (!arguments.estimate.empty() && !arguments.groundtruth.empty())
    json.update(evaluate_trajectory(arguments));
  if (!arguments.consistency.empty()) json.update(evaluate_consistency(arguments));
  if (!arguments.texture.recording.empty()) json.update(judge_texture(arguments));
  if (!arguments.measure.result.empty()) json["measure"] = evaluate_measure(arguments.measure);
  if (!arguments.meshes.empty() && arguments.texture.recording.empty())
    json.update(evaluate_meshes(arguments));
  if (!arguments.cloud.empty() && !arguments.surface.empty() && arguments.meshes.empty())
    json.update(evaluate_surface(arguments));
  if (arguments.layers) json.update(evaluate_layers(arguments));
  if (json.empty())
    throw SetupError({ErrorCode::kInvalidArgument,
                      "nothing to compare: give --estimate and --groundtruth, --estimate and "
                      "--consistency, --cloud and --surface, --mesh, "
                      "--measure and --truth, or --cloud and --layers"});
  std::cout << json.dump(2) << "\n";
  return 0;
}

void add_texture_options(CLI::App& evaluate, TextureJudging& judging, CLI::Option* estimate) {
  CLI::Option* texture =
      evaluate
          .add_option("--texture", judging.recording,
                      "Recording that gives the --mesh a texture, with --estimate as its poses: "
                      "every eighth view is left out, and PSNR says how "
                      "near images of the mesh come to them, with the texture and with the colours "
                      "of its vertices")
          ->needs(estimate);
  evaluate
      .add_option("--pictures", judging.images,
                  "Write the pages of that texture and the pictures into this folder")
      ->needs(texture);
  evaluate.add_option("--texel", judging.texel_mm, "Largest side of a texel [mm]")
      ->needs(texture)
      ->capture_default_str();
  evaluate.add_option("--views", judging.max_views, "Frames the texture is made from at the most")
      ->needs(texture)
      ->capture_default_str();
  evaluate.add_option("--blend", judging.blended_views, "Views a texel is made from at the most")
      ->needs(texture)
      ->capture_default_str();
  evaluate
      .add_flag("--keep-exposure", judging.keeps_exposure, "Take the views for equally exposed")
      ->needs(texture);
  evaluate
      .add_flag("--keep-poses", judging.keeps_poses,
                "Neither refine the poses of the views nor bend their images")
      ->needs(texture);
}

void add_measure_options(CLI::App& evaluate, MeasureJudging& judging) {
  CLI::Option* measure =
      evaluate.add_option("--measure", judging.result,
                          "Folder as hermite reconstruct writes it: what is measured between "
                          "random places in it against --truth. Keys: the "
                          "share of true distances inside the interval, in all and by the "
                          "distance, medians of half-widths and errors, "
                          "and the same of the other kinds");
  CLI::Option* truth = evaluate
                           .add_option("--truth", judging.sequence,
                                       "Sequence with true poses and depth without noise")
                           ->needs(measure);
  measure->needs(truth);
  evaluate.add_option("--pairs", judging.pairs, "How many; of what needs planes a twentieth")
      ->needs(measure)
      ->check(CLI::Range(1, 1'000'000))
      ->capture_default_str();
  evaluate.add_option("--seed", judging.seed, "Other pairs for each")
      ->needs(measure)
      ->capture_default_str();
  evaluate.add_option("--pairs-csv", judging.csv, "Write all of them here")->needs(measure);
}

}  // namespace

Command add_evaluate_command(CLI::App& app) {
  auto arguments = std::make_shared<EvaluateArguments>();
  CLI::App& evaluate =
      *app.add_subcommand("evaluate", "Errors of a trajectory and of a cloud, as JSON");
  CLI::Option* estimate =
      evaluate.add_option("--estimate", arguments->estimate,
                          "Trajectory to judge, TUM format; it also says where the cloud lies");
  CLI::Option* groundtruth =
      evaluate.add_option("--groundtruth", arguments->groundtruth,
                          "The true one, TUM format, or a sequence with true poses (default: those "
                          "of the surface's or consistency's sequence)");
  evaluate
      .add_option("--per-frame", arguments->per_frame,
                  "Write the errors of each matched frame here, CSV: index, time, translation [m] "
                  "and rotation [deg] after the alignment, and "
                  "those of the step from the frame before")
      ->needs(estimate)
      ->needs(groundtruth);
  CLI::Option* consistency =
      evaluate
          .add_option("--consistency", arguments->consistency,
                      "Sequence whose depth images are to agree under the estimate, and beside it "
                      "under the ground truth where there is one. "
                      "Keys per spacing: pairs that overlap, of pairs_tried; of the distances "
                      "between the surfaces of two frames "
                      "estimate_median_m and _rms_m; estimate_overlap; estimate_better_share of "
                      "the pairs, by their medians; and groundtruth_... "
                      "alike")
          ->needs(estimate);
  evaluate
      .add_option("--spacing", arguments->spacings,
                  "Frames between the two of a pair, several with commas")
      ->needs(consistency)
      ->delimiter(',')
      ->capture_default_str();
  CLI::Option* surface = evaluate.add_option("--surface", arguments->surface,
                                             "True surface: a PLY mesh or cloud, or a sequence "
                                             "with true poses: its depth, or synthetic:...");
  CLI::Option* cloud = evaluate.add_option(
      "--cloud", arguments->cloud,
      "Cloud to judge, PLY: with --surface distances up to 10 cm, completeness at 5 and 10 mm");
  evaluate.add_option(
      "--mesh", arguments->meshes,
      "Meshes to judge, PLY: edges with more than two faces, flipped faces and the like. With "
      "--surface, a sequence, their distances up to "
      "10 cm, the same within 2 cm of creases, precision, recall and F-score at 5 and 10 mm, and "
      "depth in 200 views beside the path; with "
      "--cloud the same of the cloud, and the vertices farther than two cells from it");
  evaluate.add_option(
      "--surfels", arguments->surfels,
      "What the mesh was made of, PLY: vertices are to lie near to it (default: the cloud)");
  add_texture_options(evaluate, arguments->texture, estimate);
  add_measure_options(evaluate, arguments->measure);
  evaluate.add_option("--cell", arguments->cell_m, "Side of a cell of the mesh [m]")
      ->capture_default_str()
      ->check(CLI::Range(1e-4, 1.0));
  evaluate
      .add_flag("--layers", arguments->layers,
                "Share of that cloud's points, which need normals, that have another layer of the "
                "same surface 1 to 3 cm before or behind "
                "them")
      ->needs(cloud);
  evaluate
      .add_option("--colored", arguments->colored,
                  "Write that cloud here, coloured by its error: blue none, red 2 cm and more")
      ->needs(surface);
  return {&evaluate, [arguments] { return run_evaluate(*arguments); }};
}

}  // namespace hermite::commands
