// hermite export
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <utility>
#include <vector>

#include "core/dataset/text_file.h"
#include "core/edit/edited.h"
#include "core/export/formats.h"
#include "core/export/scan_recording.h"
#include "core/export/texture_frames.h"
#include "core/measure/measure.h"
#include "core/report/reported_up.h"
#include "core/texture/texture.h"
#include "core/thumbnail/up_direction.h"
#include "server/commands.h"
#include "server/offline_run.h"
#include "server/ply_file.h"

namespace hermite::commands {

namespace {

struct ExportArguments {
  std::string result, format, out, sequence, camera, edits;
  double texel_mm = 1000 * texture::TextureOptions().texel_m;
};

// Returns the path of a file in the folder of a result; if the result is a PLY file, that file.
std::string path_in_result(const ExportArguments& arguments, const char* name) {
  if (!dataset::is_folder(arguments.result)) {
    if (!dataset::is_file(arguments.result))
      throw SetupError({ErrorCode::kNotFound,
                        arguments.result + ": there is no such file, and no folder of a result"});
    return arguments.result;
  }
  return arguments.result + "/" + name;
}

std::vector<edit::ScanEdit> edits_to_apply(const ExportArguments& arguments) {
  if (arguments.edits.empty()) return {};
  const Result<edit::ScanEdits> edits =
      edit::parse_scan_edits(or_throw(dataset::read_text_file(arguments.edits)));
  if (!edits.ok()) throw SetupError(in_context(arguments.edits, edits.error()));
  return edits->edits;
}

SetupError nothing_is_left(const ExportArguments& arguments) {
  return SetupError({ErrorCode::kInvalidArgument, fmt::format("{}: these edits leave nothing of {}",
                                                              arguments.edits, arguments.result)});
}

output::TriangleMesh mesh_to_export(const ExportArguments& arguments) {
  const std::string path = path_in_result(arguments, "mesh.ply");
  if (!dataset::is_file(path))
    throw SetupError(
        {ErrorCode::kNotFound,
         fmt::format(
             "{} has no mesh.ply, of which {} is made: `hermite mesh {}` makes one of its cloud",
             arguments.result, arguments.format, arguments.result)});
  Result<output::TriangleMesh> mesh = output::mesh_of(read_ply_file(path));
  if (!mesh.ok()) throw SetupError(in_context(path, mesh.error()));
  const bool was_empty = mesh->triangles.empty();
  *mesh = edit::edited(*std::move(mesh), edits_to_apply(arguments));
  if (mesh->triangles.empty() && !was_empty) throw nothing_is_left(arguments);
  return *std::move(mesh);
}

output::Cloud cloud_to_export(const ExportArguments& arguments, const char* name = "cloud.ply") {
  output::Cloud cloud = output::cloud_of(read_ply_file(path_in_result(arguments, name)));
  const bool was_empty = cloud.empty();
  cloud = edit::edited(std::move(cloud), edits_to_apply(arguments));
  if (cloud.empty() && !was_empty) throw nothing_is_left(arguments);
  return cloud;
}

// Makes the plan of the surfels, if the result has them: its cloud is thinned. What is known of the
// poses gives the plan its intervals.
plan::FloorPlan plan_to_export(const ExportArguments& arguments) {
  const output::Cloud cloud = cloud_to_export(
      arguments, dataset::is_file(arguments.result + "/surfels.ply") ? "surfels.ply" : "cloud.ply");
  const std::string trajectory = arguments.result + "/trajectory.txt",
                    report = arguments.result + "/report.json";
  std::optional<dataset::Trajectory> path;
  std::optional<measure::MapKnowledge> map;
  if (dataset::is_file(trajectory)) path = or_throw(dataset::read_tum_trajectory(trajectory));
  std::optional<UpDirection> measured_up;
  if (dataset::is_file(report))
    measured_up = report::up_in_report(or_throw(dataset::read_text_file(report)));
  if (path && dataset::is_file(report))
    map = or_throw(measure::map_knowledge_of(or_throw(dataset::read_text_file(trajectory)),
                                             or_throw(dataset::read_text_file(report))));
  const Eigen::Vector3f up = thumbnail::best_up(cloud, measured_up);
  return or_throw(plan::floor_plan_of(
      {cloud, up.cast<double>(), path ? &*path : nullptr, map ? &*map : nullptr}));
}

dataset::Trajectory trajectory_to_export(const ExportArguments& arguments) {
  if (!dataset::is_folder(arguments.result))
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         fmt::format("{} is made of trajectory.txt: give the folder of a result, not {}",
                     arguments.format, arguments.result)});
  return or_throw(dataset::read_tum_trajectory(arguments.result + "/trajectory.txt"));
}

std::unique_ptr<dataset::Sequence> sequence_to_export(const ExportArguments& arguments) {
  OfflineArguments source;
  source.sequence = arguments.sequence;
  source.camera = arguments.camera;
  std::unique_ptr<dataset::Sequence> sequence = open_source(source);
  const std::string report = arguments.result + "/report.json";
  if (!arguments.camera.empty() || !dataset::is_file(report)) return sequence;
  return or_throw(
      exports::as_scanned(std::move(sequence), or_throw(dataset::read_text_file(report))));
}

// Returns the mesh, with the colours of the recording if one is given.
output::TriangleMesh textured_mesh_to_export(const ExportArguments& arguments,
                                             const exports::ExportFormat& format) {
  output::TriangleMesh mesh = mesh_to_export(arguments);
  if (arguments.sequence.empty()) return mesh;
  if (!format.takes_texture)
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         arguments.format +
             " has no texture, for which --sequence is given: glb, glb-draco and obj have one"});
  const std::unique_ptr<dataset::Sequence> sequence = sequence_to_export(arguments);
  texture::TextureOptions options;
  options.texel_m = arguments.texel_mm / 1000;
  constexpr std::int64_t kSteps = 1000;
  Progress line(kSteps);
  const auto progress = [&line](double share) {
    line.show(static_cast<std::int64_t>(share * kSteps), "texture");
    return true;
  };
  return or_throw(texture::textured(
      mesh, exports::texture_frames_of(*sequence, trajectory_to_export(arguments)), options,
      progress));
}

void export_photos(const ExportArguments& arguments, const exports::ExportFormat& format) {
  if (arguments.sequence.empty())
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         arguments.format + " has images: --sequence names the recording that they are in"});
  const dataset::Trajectory trajectory = trajectory_to_export(arguments);
  const output::Cloud cloud = cloud_to_export(arguments);
  const std::unique_ptr<dataset::Sequence> sequence = sequence_to_export(arguments);
  std::unique_ptr<Progress> line;
  const auto progress = [&line](std::int64_t done, std::int64_t total) {
    if (!line) line = std::make_unique<Progress>(total);
    if (done < total) line->show(done + 1, "frames looked at");
    return true;
  };
  const exports::PhotoSummary summary =
      or_throw(format.of_photos({*sequence, trajectory, cloud}, {}, arguments.out, progress));
  std::cout << summary.image_count << " keyframes of " << summary.tracked_count
            << " frames with a pose, of " << summary.frame_count << ", and " << summary.point_count
            << " points in " << arguments.out << '\n';
}

int run_export(const ExportArguments& arguments) {
  const exports::ExportFormat format = or_throw(exports::export_format_named(arguments.format));
  if (!arguments.edits.empty() && !format.of_mesh && !format.of_cloud && !format.of_plan)
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         arguments.format + " is neither a mesh nor a cloud, of which --edits takes parts out"});
  if (format.of_photos) {
    export_photos(arguments, format);
    return 0;
  }
  const output::NamedFiles files =
      or_throw(format.of_mesh    ? format.of_mesh(textured_mesh_to_export(arguments, format))
               : format.of_plan  ? format.of_plan(plan_to_export(arguments))
               : format.of_cloud ? format.of_cloud(cloud_to_export(arguments))
                                 : format.of_trajectory(trajectory_to_export(arguments)));
  or_throw(exports::write_export(format, files, arguments.out));
  std::size_t bytes = 0;
  for (const output::NamedFile& file : files) bytes += file.bytes.size();
  std::cout << format.description << ": " << bytes << " bytes in " << arguments.out << '\n';
  return 0;
}

std::string formats_help() {
  std::string text =
      "Formats, of what they are made and what their columns mean: core/output/README.md\n";
  for (const exports::ExportFormat& format : exports::export_formats()) {
    std::string name = std::string("  ") + format.name;
    name.resize(16, ' ');
    text += name + format.description + "\n";
  }
  return text;
}

}  // namespace

Command add_export_command(CLI::App& app) {
  auto arguments = std::make_shared<ExportArguments>();
  CLI::App& exports = *app.add_subcommand("export", "Write a result as other programs read it");
  exports
      .add_option("RESULT", arguments->result,
                  "Folder that hermite reconstruct has written, or a PLY file")
      ->required();
  exports.add_option("--format", arguments->format, "One of those below")->required();
  exports
      .add_option("--out", arguments->out,
                  "File, which is replaced, or new folder (obj, colmap, nerfstudio)")
      ->required();
  exports.add_option("--sequence", arguments->sequence,
                     "The recording that RESULT was made of: colmap and nerfstudio have its "
                     "images, and glb, glb-draco and obj, when it is given, "
                     "a texture: " +
                         std::string(kSequenceHelp));
  exports
      .add_option("--texel", arguments->texel_mm,
                  "Largest side of a texel of the texture on the surface [mm]; where the camera "
                  "was near they are down to a quarter of it")
      ->check(CLI::Range(0.2, 100.0))
      ->capture_default_str();
  exports.add_option(
      "--camera", arguments->camera,
      std::string(kCameraHelp) +
          " (default: the one that report.json says it was corrected to, else the recording's)");
  exports.add_option("--edits", arguments->edits,
                     "JSON file that says what to take out of the mesh or cloud, as GET "
                     "/api/v1/scans/ID/edits of a server gives it");
  exports.footer(formats_help());
  return {&exports, [arguments] { return run_export(*arguments); }};
}

}  // namespace hermite::commands
