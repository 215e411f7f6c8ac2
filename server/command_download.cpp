// hermite-client download
#include <fmt/core.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <iostream>
#include <memory>

#include "server/client/download.h"
#include "server/client_commands.h"

namespace hermite::commands {

namespace {

struct DownloadArguments {
  ServerArguments server;
  std::string scan, format, out;
};

Result<client::DownloadTarget> download_target(const DownloadArguments& arguments) {
  Result<client::ApiTarget> api = api_target_of(arguments.server);
  if (!api.ok()) return api.error();
  client::DownloadTarget target;
  target.server = std::move(api->server);
  target.tls = std::move(api->tls);
  target.scan_id = arguments.scan;
  target.format = arguments.format;
  if (target.scan_id.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789") != std::string::npos)
    return Error{ErrorCode::kInvalidArgument,
                 "SCAN is no id of a scan: it has characters of a-z and 0-9 alone"};
  if (target.format.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789-_") !=
      std::string::npos)
    return Error{ErrorCode::kInvalidArgument,
                 "--format has other characters than a-z, 0-9, - and _"};
  return target;
}

int list_formats(const client::DownloadTarget& target) {
  const Result<std::vector<client::ExportReport>> reports = client::export_reports(target);
  if (!reports.ok()) return fail(status_of_answer(reports.error()), reports.error().message);
  for (const client::ExportReport& report : *reports)
    std::cout << report.format << "  " << report.label << "  " << report.state
              << (report.size_bytes > 0 ? fmt::format(" {} bytes", report.size_bytes) : "")
              << (report.message.empty() ? "" : ": " + report.message) << '\n';
  return 0;
}

// Returns "SCAN-mesh.glb" or, with options, for which the server may not list a file yet,
// "SCAN-mesh_s1000_c.glb".
std::string default_name(const client::DownloadTarget& target) {
  const std::size_t end = std::min(target.format.find('_'), target.format.size());
  const std::string plain = target.format.substr(0, end), suffix = target.format.substr(end);
  Result<std::vector<client::ExportReport>> reports = client::export_reports(target);
  if (reports.ok())
    for (client::ExportReport& report : *reports)
      if (report.format == plain && report.file.find('/') == std::string::npos)
        return target.scan_id + "-" +
               report.file.insert(std::min(report.file.find('.'), report.file.size()), suffix);
  return target.scan_id + "-" + target.format;
}

int run_download(const DownloadArguments& arguments) {
  const Result<client::DownloadTarget> target = download_target(arguments);
  if (!target.ok()) return fail(kUsage, target.error().message);
  if (arguments.format.empty()) return list_formats(*target);
  count_interrupts();
  InterruptCounter interrupts;
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const auto show = [terminal](const std::string& message) {
    if (terminal) std::cerr << '\r' << message << "\x1b[K" << std::flush;
  };
  client::DownloadObserver observer;
  observer.on_state = [&show](const client::ExportReport& report) {
    show(fmt::format("{} {} % {}", report.state, static_cast<int>(100 * report.done),
                     report.message));
  };
  observer.on_progress = [&show](std::uint64_t come_bytes, std::uint64_t total_bytes) {
    show(fmt::format("{} of {} MB", come_bytes / 1'000'000, total_bytes / 1'000'000));
  };
  observer.interrupted = [&interrupts] { return interrupts.count() > 0; };
  const Status done = client::download(
      *target, arguments.out.empty() ? default_name(*target) : arguments.out, observer);
  show("");
  return done.ok() ? 0 : fail(status_of_answer(done.error()), done.error().message);
}

}  // namespace

Command add_download_command(CLI::App& app) {
  auto arguments = std::make_shared<DownloadArguments>();
  CLI::App& command = *app.add_subcommand(
      "download",
      "Take what a scan that has ended can be taken away as; the server makes it first");
  command.add_option("SCAN", arguments->scan, "Id of the scan, as the viewer's address has it")
      ->required();
  command.add_option("--format", arguments->format,
                     "glb, obj, las, ..., and of a mesh with options as glb_s1000_f150 (default: "
                     "list what there is)");
  command.add_option("--out", arguments->out, "The file (default: SCAN and the name of the file)");
  add_server_options(command, arguments->server)->required();
  return {&command, [arguments] { return run_download(*arguments); }};
}

}  // namespace hermite::commands
