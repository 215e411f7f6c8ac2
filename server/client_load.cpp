// hermite-client load
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>
#include <string>

#include "core/base/printf_text.h"
#include "core/source/open_sequence.h"
#include "server/client/load.h"
#include "server/client/load_report.h"
#include "server/client/progress.h"
#include "server/client_commands.h"

namespace hermite::commands {

namespace {

constexpr double kMaxLoadRate_hz = 1000;
constexpr double kShortestLoad_s = 1;

struct LoadArguments {
  ServerArguments server;
  std::string sequence;
  int cameras = 1, viewers = 0;
  double seconds = 60, ramp_s = 0;
  double rate_hz = 0;  // 0: the recording's
  bool json = false, keep = false;
};

Result<client::LoadPlan> make_load_plan(const LoadArguments& arguments,
                                        const dataset::Sequence& sequence) {
  if (arguments.ramp_s > arguments.seconds)
    return Error{ErrorCode::kInvalidArgument,
                 printf_text("--ramp %g is longer than the test, which takes --seconds %g",
                             arguments.ramp_s, arguments.seconds)};
  Result<client::ApiTarget> api = api_target_of(arguments.server);
  if (!api.ok()) return api.error();
  client::LoadPlan plan;
  plan.request.server = api->server;
  plan.request.ca = arguments.server.ca;
  plan.request.title = "load test";
  plan.request.pacing = {
      .rate_hz = arguments.rate_hz > 0 ? arguments.rate_hz : sequence.frame_rate_hz(),
      .newest_wins = true};
  plan.api = *std::move(api);
  plan.cameras = arguments.cameras;
  plan.viewers = arguments.viewers;
  plan.time = std::chrono::duration<double>(arguments.seconds);
  plan.ramp = std::chrono::duration<double>(arguments.ramp_s);
  plan.keep = arguments.keep;
  return plan;
}

std::string progress_text(const client::LoadProgress& progress) {
  if (progress.to_prepare > 0)
    return fmt::format("preparing frame {} of {}", progress.prepared, progress.to_prepare);
  std::string text =
      fmt::format("{}: {} cameras scan, {} wait, {} viewers watch, {} frames answered",
                  client::format_duration(progress.elapsed_s), progress.scanning, progress.waiting,
                  progress.watching, progress.answered);
  return progress.finishing ? text + "; the last scans are being finished" : text;
}

int run_load_command(const LoadArguments& arguments) {
  const auto sequence = source::open_sequence(arguments.sequence);
  if (!sequence.ok()) return fail(kFailed, sequence.error().message);
  const Result<client::LoadPlan> plan = make_load_plan(arguments, **sequence);
  if (!plan.ok()) return fail(kUsage, plan.error().message);

  count_interrupts();
  client::ProgressPrinter printer(std::cerr, isatty(STDERR_FILENO) != 0);
  InterruptCounter wishes;
  const auto began = std::chrono::steady_clock::now();
  bool told_interrupt = false;
  client::LoadObserver observer;
  observer.interrupt_count = [&] { return wishes.count(); };
  observer.on_progress = [&](const client::LoadProgress& progress) {
    if (wishes.count() > 0 && !told_interrupt)
      printer.line("interrupted: the cameras finish, then comes the report; again to give up");
    told_interrupt = wishes.count() > 0;
    printer.show(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count(),
                 progress_text(progress));
  };
  const Result<client::LoadResult> result = client::run_load(**sequence, *plan, observer);
  if (!result.ok()) {
    printer.line("hermite-client: " + result.error().message);
    return kFailed;
  }
  printer.line("the load test is over");
  std::cout << (arguments.json ? client::load_report_json(*result)
                               : client::format_load_report(*result))
            << std::flush;
  return client::all_got_through(*result) ? 0 : kFailed;
}

}  // namespace

Command add_load_command(CLI::App& app) {
  auto arguments = std::make_shared<LoadArguments>();
  CLI::App& load = *app.add_subcommand(
      "load",
      "Test how many cameras and viewers a server bears: stream a sequence with many, and measure");
  load.add_option(
          "SEQUENCE", arguments->sequence,
          "Recording (folder, file or archive; see hermite inspect) or synthetic[:key=value,...]")
      ->required();
  add_server_options(load, arguments->server)->required();
  load.add_option("--cameras", arguments->cameras, "That stream live at once")
      ->check(CLI::Range(1, client::kMaxLoadCameras))
      ->capture_default_str();
  load.add_option("--viewers", arguments->viewers, "That watch the running scans, spread evenly")
      ->check(CLI::Range(0, client::kMaxLoadViewers))
      ->capture_default_str();
  load.add_option("--seconds", arguments->seconds,
                  "How long, with the ramp; a sequence that ends begins again as a new scan")
      ->check(CLI::Range(kShortestLoad_s, static_cast<double>(client::kMaxLoadSeconds)))
      ->capture_default_str();
  load.add_option("--ramp", arguments->ramp_s,
                  "Seconds over which cameras and viewers begin, one after the other")
      ->check(CLI::Range(0.0, static_cast<double>(client::kMaxLoadSeconds)))
      ->capture_default_str();
  load.add_option("--rate", arguments->rate_hz,
                  "Frames per second of each camera (default: the recording's own rate)")
      ->check(CLI::Range(0.1, kMaxLoadRate_hz));
  load.add_flag("--json", arguments->json, "Print the report as one JSON object");
  load.add_flag("--keep", arguments->keep,
                "Leave the scans on the server, with the tag \"load test\"");
  return {&load, [arguments] { return run_load_command(*arguments); }};
}

}  // namespace hermite::commands
