// hermite reconstruct
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/calibrate/calibrate.h"
#include "core/dataset/camera_file.h"
#include "core/dataset/changed_sequence.h"
#include "core/output/ply.h"
#include "core/raw/raw_frames.h"
#include "core/report/stated_uncertainty.h"
#include "core/run/results.h"
#include "server/commands.h"
#include "server/mesh_file.h"
#include "server/offline_run.h"

namespace hermite::commands {

namespace {

// A calibration is based on poses that the wrong intrinsics have distorted. With better intrinsics
// the remaining error becomes visible, and is small.
constexpr int kMostCalibrations = 2;

struct ReconstructArguments {
  OfflineArguments run;
  std::string out_folder;
  std::string raw_file;  // instead of out_folder
  std::string per_frame_file;
  bool calibrate = false;
  bool object = false;
  bool mesh = false;
};

int dump_raw(const std::string& path, const dataset::Sequence& sequence,
             dataset::FrameRange range) {
  RawFrameWriter writer = or_throw(RawFrameWriter::create(path, sequence.camera(), range.count()));
  const auto as_it_came = [](frame::RgbdFrame frame) { return frame; };
  for_each_frame(sequence, range, as_it_came,
                 [&writer](std::int64_t, const frame::RgbdFrame& frame, Progress&) {
                   or_throw(writer.append(frame));
                   return std::string();
                 });
  or_throw(writer.finish());
  std::cout << range.count() << " frames in " << path << '\n';
  return 0;
}

// Reconstructs, and repeats that with the camera if calibration finds a better one. Appends an
// object to `calibrations` each time.
OfflineRun reconstruct_calibrated(std::unique_ptr<dataset::Sequence>& sequence,
                                  dataset::FrameRange range, const pipeline::Options& options,
                                  const std::string& device, nlohmann::ordered_json& calibrations) {
  OfflineRun run = reconstruct_frames(*sequence, range, options, device);
  for (int i = 0; i < kMostCalibrations; ++i) {
    const calibrate::Calibration calibration =
        calibrate::calibrate(*sequence, range, tracked_poses(run));
    calibrations.push_back(
        nlohmann::ordered_json::parse(calibrate::format_calibration_json(calibration)));
    if (!calibration.is_applied) break;
    run = {};  // frees its memory for the next run
    sequence =
        std::make_unique<dataset::RecalibratedSequence>(std::move(sequence), calibration.camera);
    run = reconstruct_frames(*sequence, range, options, device);
  }
  return run;
}

// Returns how often poses lie within their stated accuracy.
nlohmann::ordered_json stated_json(const std::vector<report::FrameRow>& rows,
                                   const dataset::Trajectory& groundtruth) {
  const report::StatedShare share =
      report::share_inside(rows, report::stated_errors(rows, groundtruth));
  return {{"frames", share.frame_count},
          {"inside_99", share.inside_count},
          {"tracked", share.tracked_count},
          {"tracked_inside_99", share.tracked_inside_count},
          {"tracked_wrong", share.tracked_wrong_count}};
}

int run_reconstruct(const ReconstructArguments& arguments) {
  std::unique_ptr<dataset::Sequence> sequence = open_source(arguments.run);
  const dataset::FrameRange range =
      or_throw(dataset::parse_frame_range(arguments.run.frames, sequence->frame_count()));
  if (!arguments.raw_file.empty()) return dump_raw(arguments.raw_file, *sequence, range);
  pipeline::Options options = options_of(arguments.run);
  options.track.object = options.track.object || arguments.object;
  std::error_code error;
  std::filesystem::create_directories(arguments.out_folder, error);
  if (error)
    throw SetupError(
        {ErrorCode::kIo, fmt::format("creating {}: {}", arguments.out_folder, error.message())});
  nlohmann::ordered_json calibrations;
  OfflineRun run =
      arguments.calibrate
          ? reconstruct_calibrated(sequence, range, options, arguments.run.device, calibrations)
          : reconstruct_frames(*sequence, range, options, arguments.run.device);
  if (!arguments.per_frame_file.empty())
    or_throw(output::write_file_atomically(
        arguments.per_frame_file, report::format_frame_table(run.rows, sequence->groundtruth())));
  run::RunResults results =
      or_throw(run::results_of(*run.pipeline, options, sequence->groundtruth()));
  nlohmann::ordered_json report = nlohmann::ordered_json::parse(results.report_json);
  if (!sequence->groundtruth().empty())
    report["stated"] = stated_json(run.rows, sequence->groundtruth());
  if (arguments.calibrate) {
    report["calibrations"] = calibrations;
    report["camera"] = nlohmann::ordered_json::parse(
        dataset::format_camera_json({sequence->camera(), sequence->frame_rate_hz()}));
  }
  results.report_json = report.dump(2) + "\n";
  for (const auto& [name, bytes] : run::files_of(results))
    or_throw(output::write_file_atomically(arguments.out_folder + "/" + name, bytes));
  if (arguments.mesh) {
    run = {};  // frees its memory for the mesh
    report["mesh"] = make_mesh_file(mesh_source_path(arguments.out_folder), {},
                                    arguments.out_folder + "/mesh.ply");
    results.report_json = report.dump(2) + "\n";
    or_throw(
        output::write_file_atomically(arguments.out_folder + "/report.json", results.report_json));
  }
  std::cout << results.report_json;
  return 0;
}

}  // namespace

Command add_reconstruct_command(CLI::App& app) {
  auto arguments = std::make_shared<ReconstructArguments>();
  CLI::App& reconstruct =
      *app.add_subcommand("reconstruct", "Reconstruct a recorded sequence here, without a server");
  reconstruct.add_option("SEQUENCE", arguments->run.sequence, kSequenceHelp)->required();
  CLI::Option_group& result = *reconstruct.add_option_group("Result", "One of these");
  result.require_option(1);
  result.add_option("--out", arguments->out_folder,
                    "Folder for trajectory.txt, tracking.txt, cloud.ply, surfels.ply, "
                    "thumbnail.jpg and report.json");
  CLI::Option* raw = result.add_option(
      "--dump-raw", arguments->raw_file,
      "File for the decoded frames, which hermite_bench reads; reconstructs nothing");
  reconstruct.add_option("--frames", arguments->run.frames, "A:B takes frames A to B-1");
  reconstruct
      .add_option("--per-frame", arguments->per_frame_file,
                  "Write what became of each frame here, CSV: status, event, correction of the "
                  "map, inliers, surfels, milliseconds, reason")
      ->excludes(raw);
  reconstruct.add_option("--set", arguments->run.settings, "Setting, key=value; may be repeated")
      ->allow_extra_args(false)
      ->excludes(raw);
  reconstruct
      .add_option("--gpu-memory", arguments->run.gpu_memory_mb,
                  "Device memory of the scan [MB]; same as --set map.gpu_memory_mb=…")
      ->check(CLI::Range(0, 1'000'000))
      ->excludes(raw);
  reconstruct
      .add_option("--device", arguments->run.device,
                  "GPU: an index or a part of its name (default: the best one)")
      ->excludes(raw);
  reconstruct.add_option("--camera", arguments->run.camera, kCameraHelp);
  reconstruct.add_option("--noise", arguments->run.noise, kNoiseHelp);
  reconstruct
      .add_flag("--mesh", arguments->mesh,
                "Make mesh.ply, too, as hermite mesh does; the report says what came of it")
      ->excludes(raw);
  reconstruct
      .add_flag("--object", arguments->object,
                "Scan what turns or is moved before the camera, on a turntable or by hand, and "
                "leave out all else; same as --set "
                "track.object=true")
      ->excludes(raw);
  reconstruct
      .add_flag(
          "--calibrate", arguments->calibrate,
          "See in the recording what is wrong with its camera, as hermite calibrate does, and "
          "reconstruct anew with a better one where "
          "there is one; the report says what was found (calibrations) and the camera at the end")
      ->excludes(raw);
  reconstruct.footer(settings_table());
  return {&reconstruct, [arguments] { return run_reconstruct(*arguments); }};
}

}  // namespace hermite::commands
