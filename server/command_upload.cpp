// hermite-client upload, import and jobs
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "server/client/upload.h"
#include "server/client_commands.h"
#include "server/progress_line.h"
#include "server/upload_metadata.h"

namespace hermite::commands {

namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

struct UploadArguments {
  ServerArguments server;
  std::vector<std::string> paths;
  UploadRequest request;
  int patience_s = 600;
  bool wait = false, json = false;
};

struct JobsArguments {
  ServerArguments server;
  std::string cancel, retry;
  bool json = false;
};

// The result for one recording.
struct Outcome {
  int exit_status = 0;
  std::string path;
  std::string job;
  client::JobReport report;
  std::string message;  // why it failed
};

Result<client::UploadTarget> target_of(const ServerArguments& arguments) {
  Result<client::ApiTarget> api = api_target_of(arguments);
  if (!api.ok()) return api.error();
  client::UploadTarget target;
  target.server = std::move(api->server);
  target.tls = std::move(api->tls);
  return target;
}

// Returns $XDG_STATE_HOME/hermite/uploads, or ~/.local/state/hermite/uploads if that is not set.
std::string notes_folder() {
  const char* const state = std::getenv("XDG_STATE_HOME");
  if (state && *state) return std::string(state) + "/hermite/uploads";
  const char* const home = std::getenv("HOME");
  return std::string(home && *home ? home : ".") + "/.local/state/hermite/uploads";
}

std::string bar(double share) {
  constexpr int kWidth = 30;
  const int full = std::clamp(static_cast<int>(share * kWidth), 0, kWidth);
  return "[" + std::string(static_cast<std::size_t>(full), '#') +
         std::string(static_cast<std::size_t>(kWidth - full), '.') + "]";
}

std::string upload_text(const std::string& name, std::int64_t sent_bytes, std::int64_t total_bytes,
                        double seconds) {
  const double sent_mb = static_cast<double>(sent_bytes) / 1e6,
               total_mb = static_cast<double>(total_bytes) / 1e6;
  char numbers[96];
  std::snprintf(numbers, sizeof numbers, " %.1f of %.1f MB  %.1f MB/s", sent_mb, total_mb,
                seconds > 0 ? sent_mb / seconds : 0);
  return name + " " + bar(total_bytes > 0 ? sent_mb / total_mb : 0) + numbers;
}

std::string job_text(const client::JobReport& job) {
  std::string text = job.title + ": " + job.state;
  if (!job.stage.empty()) text += ", " + job.stage;
  if (job.total > 0) text += fmt::format(" {}/{}", job.done, job.total);
  if (!job.message.empty()) text += ": " + job.message;
  return text;
}

class Uploading {
 public:
  Uploading(const UploadArguments& arguments, client::UploadTarget target,
            InterruptCounter& interrupts)
      : arguments_(arguments),
        target_(std::move(target)),
        interrupts_(interrupts),
        screen_(isatty(STDERR_FILENO) != 0) {}

  int run() {
    std::vector<Outcome> outcomes;
    for (const std::string& path : arguments_.paths) {
      outcomes.push_back(send(path));
      if (!outcomes.back().message.empty())
        screen_.line(fmt::format("hermite-client: {}: {}", path, outcomes.back().message));
      if (!arguments_.wait) tell(outcomes.back());
      // The others would fail, too.
      if (interrupts_.count() > 0 || hopeless_) break;
    }
    int exit_status = 0;
    for (Outcome& outcome : outcomes) {
      if (arguments_.wait && !outcome.job.empty() && interrupts_.count() == 0) wait_for(outcome);
      if (arguments_.wait) tell(outcome);
      exit_status = std::max(exit_status, outcome.exit_status);
    }
    return exit_status;
  }

 private:
  Outcome send(const std::string& path) {
    Outcome outcome;
    outcome.path = path;
    const Result<client::UploadMetadata> metadata = upload_metadata(
        path, arguments_.request, [this](const std::string& message) { screen_.line(message); });
    const Result<client::ByteSource> source =
        metadata.ok() ? client::open_bytes(path) : Result<client::ByteSource>(metadata.error());
    if (!source.ok()) {
      outcome.exit_status = kUnusable;
      outcome.message = source.error().message;
      return outcome;
    }
    const Clock::time_point start = Clock::now();
    client::UploadObserver observer;
    observer.interrupted = [this] { return interrupts_.count() > 0; };
    observer.on_link = [this, &path](const std::string& message) {
      screen_.line(path + ": " + message);
    };
    observer.on_progress = [&](std::int64_t sent, std::int64_t total) {
      screen_.progress(upload_text(path, sent, total,
                                   std::chrono::duration<double>(Clock::now() - start).count()));
    };
    const Result<std::string> job = client::upload(*source, *metadata, target_, observer);
    screen_.clear();
    if (!job.ok()) {
      outcome.exit_status = status_of_answer(job.error());
      outcome.message = job.error().message;
      hopeless_ = job.error().code == ErrorCode::kUnauthorized;
      return outcome;
    }
    outcome.job = *job;
    outcome.report.state = "queued";
    screen_.line(fmt::format("{}: sent, {} bytes, job {}", path, source->size_bytes, *job));
    return outcome;
  }

  void wait_for(Outcome& outcome) {
    const Result<client::JobReport> report =
        client::wait_for_job(target_, outcome.job, [this](const client::JobReport& job) {
          if (!job.id.empty()) screen_.progress(job_text(job));
          return interrupts_.count() == 0;
        });
    screen_.clear();
    if (!report.ok()) {
      outcome.exit_status = status_of_answer(report.error());
      outcome.message = report.error().message;
      screen_.line(fmt::format("hermite-client: {}: {}", outcome.path, outcome.message));
      return;
    }
    outcome.report = *report;
    screen_.line(outcome.path + ": " + job_text(*report));
    if (report->state != "finished") outcome.exit_status = kJobFailed;
  }

  void tell(const Outcome& outcome) const {
    if (!arguments_.json) {
      if (!outcome.job.empty()) std::cout << outcome.job << std::endl;
      return;
    }
    Json json = {{"path", outcome.path}};
    json["job"] = outcome.job.empty() ? Json() : Json(outcome.job);
    json["state"] = outcome.job.empty() ? "not sent" : outcome.report.state;
    json["scan"] = outcome.report.scan.empty() ? Json() : Json(outcome.report.scan);
    json["words"] = outcome.message.empty() ? outcome.report.message : outcome.message;
    json["exit_status"] = outcome.exit_status;
    std::cout << json.dump(-1, ' ', false, Json::error_handler_t::replace) << std::endl;
  }

  const UploadArguments& arguments_;
  const client::UploadTarget target_;
  InterruptCounter& interrupts_;
  ProgressLine screen_;
  bool hopeless_ = false;  // no other recording needs to be tried
};

int usage(const Error& error) {
  std::cerr << "hermite-client: " << error.message << '\n';
  return kUsage;
}

int run_upload(const UploadArguments& arguments) {
  Result<client::UploadTarget> target = target_of(arguments.server);
  if (!target.ok()) return usage(target.error());
  target->notes_folder = notes_folder();
  target->patience = std::chrono::seconds(arguments.patience_s);
  const auto settings = parse_settings(arguments.request.settings);
  if (!settings.ok()) return usage(settings.error());
  count_interrupts();
  InterruptCounter interrupts;
  return Uploading(arguments, *std::move(target), interrupts).run();
}

Json job_json(const client::JobReport& job) {
  return {{"id", job.id},         {"title", job.title},
          {"state", job.state},   {"stage", job.stage},
          {"done", job.done},     {"total", job.total},
          {"words", job.message}, {"scan", job.scan.empty() ? Json() : Json(job.scan)}};
}

int run_jobs(const JobsArguments& arguments) {
  const Result<client::UploadTarget> target = target_of(arguments.server);
  if (!target.ok()) return usage(target.error());
  std::vector<client::JobReport> jobs;
  Error failure;
  const auto take = [&](const Result<client::JobReport>& job) {
    if (job.ok()) jobs.push_back(*job);
    return job.ok() ? Status(Done{}) : Status(job.error());
  };
  Status status = Done{};
  if (!arguments.cancel.empty()) {
    status = take(client::change_job(*target, arguments.cancel, false));
  } else if (!arguments.retry.empty()) {
    status = take(client::change_job(*target, arguments.retry, true));
  } else {
    Result<std::vector<client::JobReport>> all = client::job_reports(*target);
    status = all.ok() ? Status(Done{}) : Status(all.error());
    if (all.ok()) jobs = *std::move(all);
  }
  if (!status.ok()) {
    std::cerr << "hermite-client: " << status.error().message << '\n';
    return status_of_answer(status.error());
  }
  if (jobs.empty() && !arguments.json) std::cout << "there are no jobs\n";
  for (const client::JobReport& job : jobs)
    std::cout << (arguments.json
                      ? job_json(job).dump(-1, ' ', false, Json::error_handler_t::replace)
                      : job.id + "  " + job_text(job))
              << '\n';
  return 0;
}

}  // namespace

Command add_upload_command(CLI::App& app) {
  auto arguments = std::make_shared<UploadArguments>();
  CLI::App& upload = *app.add_subcommand(
      "upload", "Send recordings to be reconstructed, and go on where an earlier try ended");
  upload
      .add_option("PATH", arguments->paths,
                  "Recordings: folders, files or archives (see hermite inspect)")
      ->required();
  add_server_options(upload, arguments->server)->required();
  upload.add_option("--title", arguments->request.title,
                    "Title of the scans (default: the recording's name)");
  upload.add_option("--camera", arguments->request.camera,
                    "camera.json, or one of fr1, fr2, fr3, icl-nuim, redwood");
  upload
      .add_option("--set", arguments->request.settings,
                  "Setting of the reconstruction, key=value; may be repeated")
      ->allow_extra_args(false);
  upload
      .add_option("--priority", arguments->request.priority,
                  "-100 to 100; higher ones come first, above 0 with a token of scope admin")
      ->check(CLI::Range(-100, 100));
  upload
      .add_option("--patience", arguments->patience_s,
                  "So long a server that is away or full is asked again, in seconds (default 600)")
      ->check(CLI::Range(0, 86'400));
  upload.add_flag("--no-check", arguments->request.no_check,
                  "Do not open the recordings before they are sent");
  upload.add_flag("--wait", arguments->wait, "Wait until every job has ended");
  upload.add_flag("--json", arguments->json, "One JSON object a recording, on a line");
  return {&upload, [arguments] { return run_upload(*arguments); }};
}

Command add_import_command(CLI::App& app) {
  auto arguments = std::make_shared<UploadArguments>();
  arguments->request.import = arguments->wait = true;
  CLI::App& command = *app.add_subcommand(
      "import",
      "Bring clouds and meshes of other programs along, as scans to look at and to share");
  command.add_option("FILE", arguments->paths, "PLY (points or a mesh) or GLB")->required();
  add_server_options(command, arguments->server)->required();
  command.add_option("--title", arguments->request.title,
                     "Title of the scans (default: the file's name)");
  const auto add_setting = [&command, arguments](const char* name, const char* key,
                                                 const char* description) {
    command.add_option_function<std::string>(
        name,
        [arguments, key](const std::string& value) {
          arguments->request.settings.push_back(std::string(key) + "=" + value);
        },
        description);
  };
  add_setting("--scale", "scale",
              "Metres of a unit of the file (default 1): 0.001 for millimetres");
  add_setting("--up", "up",
              "Which axis of the file is up: y, z or -y (default: of a GLB y, of a PLY z)");
  command
      .add_option("--patience", arguments->patience_s,
                  "So long a server that is away or full is asked again, in seconds (default 600)")
      ->check(CLI::Range(0, 86'400));
  command.add_flag("--json", arguments->json, "One JSON object a file, on a line");
  return {&command, [arguments] { return run_upload(*arguments); }};
}

Command add_jobs_command(CLI::App& app) {
  auto arguments = std::make_shared<JobsArguments>();
  CLI::App& jobs =
      *app.add_subcommand("jobs", "List the server's jobs, cancel one or try one again");
  add_server_options(jobs, arguments->server)->required();
  jobs.add_option("--cancel", arguments->cancel,
                  "Cancel this job, or put it away when it has failed");
  jobs.add_option("--retry", arguments->retry,
                  "Try this job again, which has failed or was cancelled");
  jobs.add_flag("--json", arguments->json, "One JSON object a job, on a line");
  return {&jobs, [arguments] { return run_jobs(*arguments); }};
}

}  // namespace hermite::commands
