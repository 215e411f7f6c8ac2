// hermite-client stream
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include "core/dataset/frame_range.h"
#include "core/evaluate/accuracy_report.h"
#include "core/source/open_sequence.h"
#include "server/client/progress.h"
#include "server/client/stream.h"
#include "server/client_commands.h"

namespace hermite::commands {
namespace {

constexpr double kMaxRate_hz = 1000;

struct StreamArguments {
  StreamTarget target;
  std::string sequence;
  std::string frames;
  std::string rate;
  std::string camera;
  bool live = false;
};

Result<client::Pacing> parse_pacing(const StreamArguments& arguments, double recorded_rate_hz) {
  client::Pacing pacing{.rate_hz = std::nullopt, .newest_wins = arguments.live};
  if (arguments.rate.empty() || arguments.rate == "max") {
    if (arguments.live && !arguments.rate.empty()) {
      return Error{ErrorCode::kInvalidArgument,
                   "--live has a clock: --rate max does not go with it"};
    }
    if (arguments.live) pacing.rate_hz = recorded_rate_hz;
    return pacing;
  }
  double rate_hz = 0;
  const char* const end = arguments.rate.data() + arguments.rate.size();
  const auto parsed = std::from_chars(arguments.rate.data(), end, rate_hz);
  if (parsed.ec != std::errc() || parsed.ptr != end || !(rate_hz > 0 && rate_hz <= kMaxRate_hz)) {
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("--rate \"{}\": expected max or a number above 0, at most 1000",
                             arguments.rate)};
  }
  pacing.rate_hz = rate_hz;
  return pacing;
}

Result<std::unique_ptr<dataset::Sequence>> open_with_camera(const StreamArguments& arguments) {
  if (arguments.camera.empty()) return source::open_sequence(arguments.sequence);
  const auto camera = dataset::read_camera(arguments.camera);
  if (!camera.ok()) return camera.error();
  return source::open_sequence(arguments.sequence, *camera);
}

// Returns the server's report, with the accuracy if the recording has ground truth.
Result<std::string> complete_report(const client::StreamOutcome& outcome,
                                    const dataset::Sequence& sequence) {
  if (sequence.groundtruth().empty()) return outcome.report_json;
  const auto trajectory = dataset::parse_tum_trajectory(outcome.trajectory_tum);
  if (!trajectory.ok()) return in_context("the server's trajectory", trajectory.error());
  return evaluate::add_accuracy(outcome.report_json, *trajectory, sequence.groundtruth());
}

int run_stream(const StreamArguments& arguments) {
  const auto sequence = open_with_camera(arguments);
  if (!sequence.ok()) return fail(kFailed, sequence.error().message);
  auto request = make_stream_request(arguments.target, (*sequence)->name());
  if (!request.ok()) return fail(kUsage, request.error().message);
  const auto pacing = parse_pacing(arguments, (*sequence)->frame_rate_hz());
  if (!pacing.ok()) return fail(kUsage, pacing.error().message);
  request->pacing = *pacing;
  const auto frames = dataset::parse_frame_range(arguments.frames, (*sequence)->frame_count());
  if (!frames.ok()) return fail(kUsage, frames.error().message);

  count_interrupts();
  client::ProgressPrinter printer(std::cerr, isatty(STDERR_FILENO) != 0);
  InterruptCounter wishes;
  bool told_interrupt = false;
  client::StreamObserver observer;
  observer.interrupt_count = [&] { return wishes.count(); };
  observer.on_problem = [&](const std::string& message) { printer.line(message); };
  observer.on_link = [&](const std::string& message) { printer.line(message); };
  observer.on_event = [&](const wire::FrameResult& result) {
    printer.line(client::format_event(result));
  };
  observer.on_progress = [&](const client::StreamProgress& progress) {
    if (wishes.count() > 0 && !told_interrupt)
      printer.line(
          "interrupted: waiting for the result of the frames sent so far; again to give up");
    told_interrupt = wishes.count() > 0;
    printer.show(progress);
  };
  const auto outcome = client::stream_sequence(**sequence, *frames, *request, observer);
  if (!outcome.ok()) {
    printer.line("hermite-client: " + outcome.error().message);
    return kFailed;
  }
  printer.line(client::format_summary(outcome->progress));
  const auto report = complete_report(*outcome, **sequence);
  if (!report.ok()) return fail(kFailed, report.error().message);
  return print_report(*report, arguments.target);
}

}  // namespace

Command add_stream_command(CLI::App& app) {
  auto arguments = std::make_shared<StreamArguments>();
  CLI::App& stream = *app.add_subcommand(
      "stream", "Stream a recorded sequence and print the server's report as JSON");
  stream
      .add_option(
          "SEQUENCE", arguments->sequence,
          "Recording (folder, file or archive; see hermite inspect) or synthetic[:key=value,...]")
      ->required();
  add_stream_options(stream, arguments->target)->required();
  stream.add_option("--frames", arguments->frames, "A:B streams frames A to B-1");
  stream.add_option("--rate", arguments->rate,
                    "Frames per second, or max (default; with --live: the recording's own rate)");
  stream.add_flag("--live", arguments->live,
                  "As a live camera: drop frames rather than wait for the server");
  stream.add_option("--camera", arguments->camera,
                    "camera.json, or one of fr1, fr2, fr3, icl-nuim, redwood");
  return {&stream, [arguments] { return run_stream(*arguments); }};
}

}  // namespace hermite::commands
