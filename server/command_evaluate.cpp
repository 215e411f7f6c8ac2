// hermite evaluate
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "server/commands.h"
#include "server/evaluate_measure.h"
#include "server/evaluate_shape.h"
#include "server/evaluate_texture.h"
#include "server/evaluate_trajectory.h"

namespace hermite::commands {

namespace {

using Json = nlohmann::ordered_json;

struct EvaluateArguments {
  TrajectoryJudging trajectory;
  ShapeJudging shape;
  bool layers = false;
  TextureJudging texture;
  MeasureJudging measure;
};

Json judge_texture(const EvaluateArguments& arguments) {
  if (arguments.shape.meshes.size() != 1)
    throw SetupError({ErrorCode::kInvalidArgument, "--texture judges one --mesh"});
  TextureJudging judging = arguments.texture;
  judging.mesh = arguments.shape.meshes.front();
  judging.trajectory = arguments.trajectory.estimate;
  return evaluate_texture(judging);
}

int run_evaluate(const EvaluateArguments& arguments) {
  ShapeJudging shape = arguments.shape;
  shape.estimate = arguments.trajectory.estimate;
  shape.groundtruth = arguments.trajectory.groundtruth;
  Json json = Json::object();
  if (!arguments.trajectory.estimate.empty() && !arguments.trajectory.groundtruth.empty())
    json.update(evaluate_trajectory(arguments.trajectory));
  if (!arguments.trajectory.consistency.empty())
    json.update(evaluate_consistency(arguments.trajectory));
  if (!arguments.texture.recording.empty()) json.update(judge_texture(arguments));
  if (!arguments.measure.result.empty()) json["measure"] = evaluate_measure(arguments.measure);
  if (!shape.meshes.empty() && arguments.texture.recording.empty())
    json.update(evaluate_meshes(shape));
  if (!shape.cloud.empty() && !shape.surface.empty() && shape.meshes.empty())
    json.update(evaluate_surface(shape));
  if (arguments.layers) json.update(evaluate_layers(shape.cloud));
  if (json.empty())
    throw SetupError({ErrorCode::kInvalidArgument,
                      "nothing to compare: give --estimate and --groundtruth, --estimate and "
                      "--consistency, --cloud and --surface, --mesh, "
                      "--measure and --truth, or --cloud and --layers"});
  std::cout << json.dump(2) << "\n";
  return 0;
}

// Returns the option --estimate.
CLI::Option* add_trajectory_options(CLI::App& evaluate, TrajectoryJudging& judging) {
  CLI::Option* estimate =
      evaluate.add_option("--estimate", judging.estimate,
                          "Trajectory to judge, TUM format; it also says where the cloud lies");
  CLI::Option* groundtruth =
      evaluate.add_option("--groundtruth", judging.groundtruth,
                          "The true one, TUM format, or a sequence with true poses (default: those "
                          "of the surface's or consistency's sequence)");
  evaluate
      .add_option("--per-frame", judging.per_frame,
                  "Write the errors of each matched frame here, CSV: index, time, translation [m] "
                  "and rotation [deg] after the alignment, and "
                  "those of the step from the frame before")
      ->needs(estimate)
      ->needs(groundtruth);
  CLI::Option* consistency =
      evaluate
          .add_option("--consistency", judging.consistency,
                      "Sequence whose depth images are to agree under the estimate, and beside it "
                      "under the ground truth where there is one. "
                      "Keys per spacing: pairs that overlap, of pairs_tried; of the distances "
                      "between the surfaces of two frames "
                      "estimate_median_m and _rms_m; estimate_overlap; estimate_better_share of "
                      "the pairs, by their medians; and groundtruth_... "
                      "alike")
          ->needs(estimate);
  evaluate
      .add_option("--spacing", judging.spacings,
                  "Frames between the two of a pair, several with commas")
      ->needs(consistency)
      ->delimiter(',')
      ->capture_default_str();
  return estimate;
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
  CLI::Option* estimate = add_trajectory_options(evaluate, arguments->trajectory);
  CLI::Option* surface = evaluate.add_option("--surface", arguments->shape.surface,
                                             "True surface: a PLY mesh or cloud, or a sequence "
                                             "with true poses: its depth, or synthetic:...");
  CLI::Option* cloud = evaluate.add_option(
      "--cloud", arguments->shape.cloud,
      "Cloud to judge, PLY: with --surface distances up to 10 cm, completeness at 5 and 10 mm");
  evaluate.add_option(
      "--mesh", arguments->shape.meshes,
      "Meshes to judge, PLY: edges with more than two faces, flipped faces and the like. With "
      "--surface, a sequence, their distances up to "
      "10 cm, the same within 2 cm of creases, precision, recall and F-score at 5 and 10 mm, and "
      "depth in 200 views beside the path; with "
      "--cloud the same of the cloud, and the vertices farther than two cells from it");
  evaluate.add_option(
      "--surfels", arguments->shape.surfels,
      "What the mesh was made of, PLY: vertices are to lie near to it (default: the cloud)");
  add_texture_options(evaluate, arguments->texture, estimate);
  add_measure_options(evaluate, arguments->measure);
  evaluate.add_option("--cell", arguments->shape.cell_m, "Side of a cell of the mesh [m]")
      ->capture_default_str()
      ->check(CLI::Range(1e-4, 1.0));
  evaluate
      .add_flag("--layers", arguments->layers,
                "Share of that cloud's points, which need normals, that have another layer of the "
                "same surface 1 to 3 cm before or behind "
                "them")
      ->needs(cloud);
  evaluate
      .add_option("--colored", arguments->shape.colored,
                  "Write that cloud here, coloured by its error: blue none, red 2 cm and more")
      ->needs(surface);
  return {&evaluate, [arguments] { return run_evaluate(*arguments); }};
}

}  // namespace hermite::commands
