// hermite-client: streams recordings to a Hermite server. Exit status: 0 well, 1 the scan or the connection failed, 2 usage.
#include <unistd.h>

#include <atomic>
#include <charconv>
#include <chrono>
#include <csignal>
#include <iostream>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/dataset/frame_range.h"
#include "core/dataset/sequence.h"
#include "core/evaluate/accuracy_report.h"
#include "core/output/ply.h"
#include "server/client/progress.h"
#include "server/client/server_url.h"
#include "server/client/stream.h"

namespace {

using namespace hermite;

constexpr int kFailed = 1;
constexpr int kUsage = 2;
constexpr double kMaxRate_hz = 1000;

// Written by the signal handler only.
std::atomic<int> interrupts{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may touch it");

struct StreamArguments {
  std::string sequence;
  std::string server;
  std::string token;
  std::string ca;
  std::string frames;
  std::string rate;
  std::string report_path;
  std::optional<std::string> title;
  std::string camera;
  std::vector<std::string> settings;
  bool live = false;
};

int fail(int exit_status, const std::string& words) {
  std::cerr << "hermite-client: " << words << '\n';
  return exit_status;
}

void add_stream_command(CLI::App& app, StreamArguments& arguments) {
  CLI::App& stream = *app.add_subcommand("stream", "Stream a recorded sequence and print the server's report as JSON");
  stream
      .add_option("SEQUENCE", arguments.sequence, "Recording (folder, file or archive; see hermite inspect) or synthetic[:key=value,...]")
      ->required();
  stream
      .add_option("--server", arguments.server,
                  "http://HOST:PORT or https://HOST:PORT, or the address as the server prints it, with #token=...")
      ->required();
  stream.add_option("--token", arguments.token, "The server's token, unless the address has it")->envname("HERMITE_TOKEN");
  stream.add_option("--ca", arguments.ca, "Believe the certificate authorities in this file (PEM) instead of the system's")
      ->envname("HERMITE_CA");
  stream.add_option("--frames", arguments.frames, "A:B streams frames A to B-1");
  stream.add_option("--rate", arguments.rate, "Frames per second, or max (default; with --live: the recording's own rate)");
  stream.add_option("--report", arguments.report_path, "Also write the report to this file");
  stream.add_option("--title", arguments.title, "Title of the scan (default: the sequence's name)");
  stream.add_flag("--live", arguments.live, "As a live camera: drop frames rather than wait for the server");
  stream.add_option("--set", arguments.settings, "Setting of the reconstruction, key=value; may be repeated")->allow_extra_args(false);
  stream.add_option("--camera", arguments.camera, "camera.json, or one of fr1, fr2, fr3, icl-nuim, redwood");
}

Result<Pacing> parse_pacing(const StreamArguments& arguments, double recorded_rate_hz) {
  Pacing pacing{.rate_hz = std::nullopt, .newest_wins = arguments.live};
  if (arguments.rate.empty() || arguments.rate == "max") {
    if (arguments.live && !arguments.rate.empty()) {
      return Error{ErrorCode::kInvalidArgument, "--live has a clock: --rate max does not go with it"};
    }
    if (arguments.live) pacing.rate_hz = recorded_rate_hz;
    return pacing;
  }
  double rate_hz = 0;
  const char* const end = arguments.rate.data() + arguments.rate.size();
  const auto parsed = std::from_chars(arguments.rate.data(), end, rate_hz);
  if (parsed.ec != std::errc() || parsed.ptr != end || !(rate_hz > 0 && rate_hz <= kMaxRate_hz)) {
    return Error{ErrorCode::kInvalidArgument, "--rate \"" + arguments.rate + "\": expected max or a number above 0, at most 1000"};
  }
  pacing.rate_hz = rate_hz;
  return pacing;
}

Result<std::map<std::string, std::string>> parse_settings(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> settings;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0) return Error{ErrorCode::kInvalidArgument, "--set \"" + text + "\": expected key=value"};
    settings[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return settings;
}

// What the arguments ask for, once the sequence is open. Errors are the user's.
Result<StreamRequest> make_request(const StreamArguments& arguments, const Sequence& sequence) {
  StreamRequest request;
  auto url = parse_server_url(arguments.server);
  if (!url.ok()) return url.error();
  request.server = *std::move(url);
  request.ca = arguments.ca;
  if (!arguments.token.empty()) request.server.token = arguments.token;
  if (request.server.token.empty()) return Error{ErrorCode::kInvalidArgument, "no token: give --token, or --server with #token=..."};
  const auto frames = parse_frame_range(arguments.frames, sequence.frame_count());
  if (!frames.ok()) return frames.error();
  request.frames = *frames;
  const auto pacing = parse_pacing(arguments, sequence.frame_rate_hz());
  if (!pacing.ok()) return pacing.error();
  request.pacing = *pacing;
  auto settings = parse_settings(arguments.settings);
  if (!settings.ok()) return settings.error();
  request.settings = *std::move(settings);
  request.title = arguments.title.value_or(sequence.name());
  return request;
}

Result<std::unique_ptr<Sequence>> open_with_camera(const StreamArguments& arguments) {
  if (arguments.camera.empty()) return open_sequence(arguments.sequence);
  const auto camera = read_camera(arguments.camera);
  if (!camera.ok()) return camera.error();
  return open_sequence(arguments.sequence, *camera);
}

// The server's report, with the accuracy where the recording knows the truth.
Result<std::string> complete_report(const StreamOutcome& outcome, const Sequence& sequence) {
  if (sequence.groundtruth().empty()) return outcome.report_json;
  const auto trajectory = parse_tum_trajectory(outcome.trajectory_tum);
  if (!trajectory.ok()) return in_context("the server's trajectory", trajectory.error());
  return add_accuracy(outcome.report_json, *trajectory, sequence.groundtruth());
}

void on_signal(int) { interrupts.fetch_add(1); }

// 0, 1 or 2: whether somebody wants an end, and then whether somebody insists. Signals within a second of the first are the same wish:
// wrappers pass on what the terminal has sent to everyone already.
class InterruptCounter {
 public:
  int count() {
    const int signals = interrupts.load();
    if (signals == 0) return 0;
    const auto now = std::chrono::steady_clock::now();
    if (!first_) first_ = now;
    if (now - *first_ < std::chrono::seconds(1)) first_wish_ = signals;
    return signals > first_wish_ ? 2 : 1;
  }

 private:
  std::optional<std::chrono::steady_clock::time_point> first_;
  int first_wish_ = 1;
};

int run_stream(const StreamArguments& arguments) {
  const auto sequence = open_with_camera(arguments);
  if (!sequence.ok()) return fail(kFailed, sequence.error().message);
  const auto request = make_request(arguments, **sequence);
  if (!request.ok()) return fail(kUsage, request.error().message);

  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  ProgressPrinter printer(std::cerr, isatty(STDERR_FILENO) != 0);
  InterruptCounter wishes;
  bool told_interrupt = false;
  StreamObserver observer;
  observer.interrupt_count = [&] { return wishes.count(); };
  observer.on_problem = [&](const std::string& words) { printer.line(words); };
  observer.on_link = [&](const std::string& words) { printer.line(words); };
  observer.on_event = [&](const wire::FrameResult& result) { printer.line(format_event(result)); };
  observer.on_progress = [&](const StreamProgress& progress) {
    if (wishes.count() > 0 && !told_interrupt)
      printer.line("interrupted: waiting for the result of the frames sent so far; again to give up");
    told_interrupt = wishes.count() > 0;
    printer.show(progress);
  };
  const auto outcome = stream_sequence(**sequence, *request, observer);
  if (!outcome.ok()) {
    printer.line("hermite-client: " + outcome.error().message);
    return kFailed;
  }
  printer.line(format_summary(outcome->progress));
  const auto report = complete_report(*outcome, **sequence);
  if (!report.ok()) return fail(kFailed, report.error().message);
  std::cout << *report << std::flush;
  if (arguments.report_path.empty()) return 0;
  const Status written = write_file_atomically(arguments.report_path, *report);
  return written.ok() ? 0 : fail(kFailed, written.error().message);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Streams RGB-D recordings to a Hermite server");
  app.require_subcommand(1);
  StreamArguments arguments;
  add_stream_command(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsage;
  }
  return run_stream(arguments);
}
