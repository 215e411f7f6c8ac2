// What the subcommands of hermite-client share.
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <csignal>
#include <iostream>
#include <map>

#include "core/output/ply.h"
#include "server/client/server_url.h"
#include "server/client_commands.h"

namespace hermite::commands {
namespace {

// Changed only by the signal handler.
std::atomic<int> interrupts{0};
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler may touch it");

void on_signal(int) { interrupts.fetch_add(1); }

}  // namespace

CLI::Option* add_server_options(CLI::App& command, ServerArguments& arguments) {
  command.add_option("--token", arguments.token, "The server's token, unless the address has it")
      ->envname("HERMITE_TOKEN");
  command
      .add_option("--ca", arguments.ca,
                  "Believe the certificate authorities in this file (PEM) instead of the system's")
      ->envname("HERMITE_CA");
  return command.add_option("--server", arguments.server,
                            "http://HOST:PORT or https://HOST:PORT, or the address as the server "
                            "prints it, with #token=...");
}

CLI::Option* add_stream_options(CLI::App& command, StreamTarget& target) {
  command.add_option("--report", target.report_path, "Also write the report to this file");
  command.add_option("--title", target.title,
                     "Title of the scan (default: the name of the recording or camera)");
  command
      .add_option("--set", target.settings,
                  "Setting of the reconstruction, key=value; may be repeated")
      ->allow_extra_args(false);
  return add_server_options(command, target.server);
}

Result<client::ServerUrl> server_of(const ServerArguments& arguments) {
  Result<client::ServerUrl> url = client::parse_server_url(arguments.server);
  if (!url.ok()) return url;
  if (!arguments.token.empty()) url->token = arguments.token;
  if (url->token.empty())
    return Error{ErrorCode::kInvalidArgument,
                 "no token: give --token, or --server with #token=..."};
  return url;
}

Result<client::ApiTarget> api_target_of(const ServerArguments& arguments) {
  Result<client::ServerUrl> server = server_of(arguments);
  if (!server.ok()) return server.error();
  client::ApiTarget target{*std::move(server), {}};
  if (!target.server.tls) return target;
  Result<server::TlsContext> tls = server::client_tls(arguments.ca);
  if (!tls.ok()) return tls.error();
  target.tls = *std::move(tls);
  return target;
}

Result<std::map<std::string, std::string>> parse_settings(const std::vector<std::string>& texts) {
  std::map<std::string, std::string> settings;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos || equals == 0)
      return Error{ErrorCode::kInvalidArgument,
                   fmt::format("--set \"{}\": expected key=value", text)};
    settings[text.substr(0, equals)] = text.substr(equals + 1);
  }
  return settings;
}

Result<client::StreamRequest> make_stream_request(const StreamTarget& target,
                                                  const std::string& name) {
  client::StreamRequest request;
  Result<client::ServerUrl> server = server_of(target.server);
  if (!server.ok()) return server.error();
  request.server = *std::move(server);
  request.ca = target.server.ca;
  auto settings = parse_settings(target.settings);
  if (!settings.ok()) return settings.error();
  request.settings = *std::move(settings);
  request.title = target.title.value_or(name);
  return request;
}

int status_of_answer(const Error& error) {
  switch (error.code) {
    case ErrorCode::kUnauthorized:
    case ErrorCode::kBusy:
    case ErrorCode::kTooLarge:
    case ErrorCode::kInvalidArgument: return kRefused;
    default: return kFailed;
  }
}

int fail(int exit_status, const std::string& message) {
  std::cerr << "hermite-client: " << message << '\n';
  return exit_status;
}

int print_report(const std::string& report_json, const StreamTarget& target) {
  std::cout << report_json << std::flush;
  if (target.report_path.empty()) return 0;
  const Status written = output::write_file_atomically(target.report_path, report_json);
  return written.ok() ? 0 : fail(kFailed, written.error().message);
}

void count_interrupts() {
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
}

int InterruptCounter::count() {
  const std::lock_guard lock(mutex_);
  const int signals = interrupts.load();
  if (signals == 0) return 0;
  const auto now = std::chrono::steady_clock::now();
  if (!first_) first_ = now;
  if (now - *first_ < std::chrono::seconds(1)) first_wish_ = signals;
  return signals > first_wish_ ? 2 : 1;
}

}  // namespace hermite::commands
