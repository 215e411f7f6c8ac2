// hermite-client scan
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <chrono>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "core/dataset/sequence.h"
#include "server/capture/camera_kinds.h"
#include "server/capture/known_camera.h"
#include "server/capture/pause_key.h"
#include "server/capture/scan.h"
#include "server/capture/scan_display.h"
#include "server/client/progress.h"
#include "server/client_commands.h"

namespace hermite::commands {
namespace {

struct ScanArguments {
  StreamTarget target;
  std::string camera;
  std::string intrinsics, known_camera;
  std::string record_folder;
  std::uint64_t frame_count = 0;
  int preflight_frames = client::kPreflightFrames;
  bool list = false;
};

Result<client::ScanRequest> make_request(const ScanArguments& arguments,
                                         const client::CameraDescription& camera) {
  client::ScanRequest request;
  if (!arguments.target.server.server.empty()) {
    auto stream = make_stream_request(arguments.target, camera.name);
    if (!stream.ok()) return stream.error();
    request.stream = *std::move(stream);
  } else if (arguments.record_folder.empty()) {
    return Error{ErrorCode::kInvalidArgument, "give --server, or --record, or both"};
  }
  request.title = arguments.target.title.value_or(camera.name);
  request.record_folder = arguments.record_folder;
  request.max_frames = arguments.frame_count;
  request.preflight_frames = arguments.preflight_frames;
  return request;
}

Result<std::unique_ptr<client::CaptureCamera>> open_wanted_camera(const ScanArguments& arguments) {
  if (!arguments.known_camera.empty()) {
    const Result<std::optional<Camera>> known = client::known_camera_in(arguments.known_camera);
    if (!known.ok()) return in_context("--known-camera", known.error());
    return client::open_camera(arguments.camera, *known);
  }
  if (arguments.intrinsics.empty()) return client::open_camera(arguments.camera, std::nullopt);
  const auto intrinsics = dataset::read_camera(arguments.intrinsics);
  if (!intrinsics.ok()) return in_context("--intrinsics", intrinsics.error());
  return client::open_camera(arguments.camera, *intrinsics);
}

// The user at the terminal: reads wishes and prints messages.
class Person {
 public:
  Person() : printer_(std::cerr, isatty(STDERR_FILENO) != 0) { count_interrupts(); }

  client::ScanObserver observer() {
    client::ScanObserver observer;
    observer.wishes = [this] { return wishes(); };
    observer.on_message = [this](const std::string& message) { printer_.line(message); };
    observer.on_event = [this](const wire::FrameResult& result) {
      printer_.line(client::format_event(result));
    };
    observer.on_pause_request = [this](bool paused) {
      paused_ = paused;
      printer_.line(paused ? client::kPausedByViewer : client::kUnpausedByViewer);
    };
    observer.on_progress = [this](const client::ScanProgress& progress) {
      if (wishes_.count() > 0 && !told_interrupt_) {
        printer_.line("no more frames: waiting for the result; again to stop at once");
        told_interrupt_ = true;
      }
      printer_.show(
          std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch())
              .count(),
          client::format_scan_progress(progress));
    };
    return observer;
  }

  void line(const std::string& message) { printer_.line(message); }

 private:
  client::CaptureWishes wishes() {
    if (key_.presses() % 2 == 1) paused_ = !paused_;
    return {.paused = paused_, .interrupt_count = wishes_.count()};
  }

  client::PauseKey key_;
  InterruptCounter wishes_;
  client::ProgressPrinter printer_;
  std::atomic<bool> paused_{false};
  bool told_interrupt_ = false;
};

int run(const ScanArguments& arguments) {
  if (arguments.list) {
    std::cout << client::list_cameras();
    return 0;
  }
  const auto camera = open_wanted_camera(arguments);
  if (!camera.ok()) return fail(kFailed, camera.error().message);
  const client::CameraDescription& description = (*camera)->description();
  if (!arguments.known_camera.empty())
    if (const Status same = client::check_device(arguments.known_camera, description.name);
        !same.ok())
      return fail(kUsage, "--known-camera: " + same.error().message);
  const auto request = make_request(arguments, description);
  if (!request.ok()) return fail(kUsage, request.error().message);
  Person person;
  person.line(fmt::format("{}, intrinsics: {}", description.name, description.camera_source));
  const auto outcome = client::run_scan(**camera, *request, person.observer());
  if (!outcome.ok()) {
    person.line("hermite-client: " + outcome.error().message);
    return kFailed;
  }
  person.line(client::format_scan_summary(outcome->progress, arguments.record_folder));
  if (!outcome->stream) return 0;
  if (!arguments.known_camera.empty()) {
    const Status kept = client::keep_known_camera(outcome->stream->report_json, description.name,
                                                  arguments.known_camera);
    person.line(kept.ok() ? fmt::format("{} has what is known of the camera, for its next scan",
                                        arguments.known_camera)
                          : "--known-camera: " + kept.error().message);
  }
  return print_report(outcome->stream->report_json, arguments.target);
}

}  // namespace

Command add_scan_command(CLI::App& app) {
  auto arguments = std::make_shared<ScanArguments>();
  CLI::App& scan =
      *app.add_subcommand("scan", "Scan with an attached camera; space pauses, Ctrl-C finishes");
  scan.add_flag("--list", arguments->list, "Say which cameras there are, and end");
  scan.add_option("--camera", arguments->camera,
                  "A kind (kinect, openni, realsense), kinect:2 for the second, or "
                  "recording:SEQUENCE (default: the first there is)");
  CLI::Option* const intrinsics =
      scan.add_option("--intrinsics", arguments->intrinsics, "camera.json of this very camera");
  scan.add_option("--known-camera", arguments->known_camera,
                  "The same, and after the scan the file has what was found out about the camera, "
                  "for its next scan; it need not exist yet")
      ->excludes(intrinsics);
  scan.add_option("--record", arguments->record_folder,
                  "Keep every frame in this new folder, and send from there: nothing is lost when "
                  "the server is away");
  scan.add_option("--frames", arguments->frame_count,
                  "Finish after so many (default: with Ctrl-C)");
  scan.add_option("--preflight", arguments->preflight_frames,
                  "Frames to look at before the scan begins")
      ->check(CLI::Range(client::kMinPreflightFrames, client::kMaxPreflightFrames));
  add_stream_options(scan, arguments->target);
  return {&scan, [arguments] { return run(*arguments); }};
}

}  // namespace hermite::commands
