// hermite calibrate
#include "core/calibrate/calibrate.h"

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "core/dataset/camera_file.h"
#include "core/output/ply.h"
#include "server/commands.h"
#include "server/offline_run.h"

namespace hermite::commands {

namespace {

struct CalibrateArguments {
  OfflineArguments run;
  std::string trajectory;
  std::string out_file;
};

int run_calibrate(const CalibrateArguments& arguments) {
  const std::unique_ptr<dataset::Sequence> sequence = open_source(arguments.run);
  const dataset::FrameRange range =
      or_throw(dataset::parse_frame_range(arguments.run.frames, sequence->frame_count()));
  const dataset::Trajectory trajectory =
      arguments.trajectory.empty()
          ? tracked_poses(reconstruct_frames(*sequence, range, options_of(arguments.run),
                                             arguments.run.device))
          : or_throw(dataset::read_tum_trajectory(arguments.trajectory));
  const calibrate::Calibration calibration = calibrate::calibrate(*sequence, range, trajectory);
  const std::string camera_json =
      dataset::format_camera_json({calibration.camera, sequence->frame_rate_hz()});
  if (!arguments.out_file.empty())
    or_throw(output::write_file_atomically(arguments.out_file, camera_json));
  nlohmann::ordered_json json =
      nlohmann::ordered_json::parse(calibrate::format_calibration_json(calibration));
  json["camera"] = nlohmann::ordered_json::parse(camera_json);
  std::cout << json.dump(2) << "\n";
  return 0;
}

}  // namespace

Command add_calibrate_command(CLI::App& app) {
  auto arguments = std::make_shared<CalibrateArguments>();
  CLI::App& calibrate =
      *app.add_subcommand("calibrate",
                          "See in a recording what is wrong with its camera: "
                          "focal length, centre, distortion, bent depth, offset "
                          "of the disparity, rolling shutter, late colour; as JSON");
  calibrate.add_option("SEQUENCE", arguments->run.sequence, kSequenceHelp)->required();
  calibrate.add_option(
      "--out", arguments->out_file,
      "Write camera.json here, with what was found; as it was where nothing was worth applying");
  calibrate.add_option("--trajectory", arguments->trajectory,
                       "Poses of its tracked frames, TUM format, of an earlier reconstruction with "
                       "the same camera (default: reconstruct)");
  calibrate.add_option("--frames", arguments->run.frames, "A:B takes frames A to B-1");
  calibrate
      .add_option("--set", arguments->run.settings,
                  "Setting of the reconstruction, key=value; may be repeated")
      ->allow_extra_args(false);
  calibrate.add_option("--device", arguments->run.device,
                       "GPU: an index or a part of its name (default: the best one)");
  calibrate.add_option("--camera", arguments->run.camera, kCameraHelp);
  calibrate.add_option("--noise", arguments->run.noise, kNoiseHelp);
  calibrate.footer(settings_table());
  return {&calibrate, [arguments] { return run_calibrate(*arguments); }};
}

}  // namespace hermite::commands
