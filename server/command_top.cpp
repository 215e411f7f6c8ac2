// hermite-client top
#include <sys/ioctl.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <ctime>
#include <iostream>
#include <memory>
#include <thread>

#include "server/client/activity_text.h"
#include "server/client_commands.h"

namespace hermite::commands {

namespace {

struct TopArguments {
  ServerArguments server;
  std::string metrics;
  double interval_s = 2;
  bool once = false;
};

// The cursor to the first column of the first row, and from there on nothing.
constexpr const char* kClearScreen = "\x1b[H\x1b[J";

client::TerminalSize terminal_size() {
  winsize size{};
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) != 0) return {};
  // The cursor takes a row below the last line.
  return {size.ws_col, size.ws_row > 1 ? size.ws_row - std::size_t{1} : 0};
}

std::string time_of_day() {
  const std::time_t now = std::time(nullptr);
  std::tm local{};
  localtime_r(&now, &local);
  char text[16];
  return std::string(text, std::strftime(text, sizeof text, "%H:%M:%S", &local));
}

// Returns false if the user wants to end meanwhile.
bool wait(double interval_s, InterruptCounter& interrupts) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(interval_s);
  while (interrupts.count() == 0 && std::chrono::steady_clock::now() < until)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  return interrupts.count() == 0;
}

int run_top(const TopArguments& arguments) {
  const Result<client::ApiTarget> target = api_target_of(arguments.server);
  if (!target.ok()) return fail(kUsage, target.error().message);
  std::optional<client::ServerUrl> metrics;
  if (!arguments.metrics.empty()) {
    const Result<client::ServerUrl> url = client::parse_server_url(arguments.metrics);
    if (!url.ok()) return fail(kUsage, "--metrics: " + url.error().message);
    if (url->tls) return fail(kUsage, "--metrics: the server's metrics are not encrypted: http://");
    metrics = *url;
  }
  const bool is_screen = !arguments.once && isatty(STDOUT_FILENO) != 0;
  const std::string server = target->server.host_and_port();
  client::ActivityReader reader(*target, metrics);
  count_interrupts();
  InterruptCounter interrupts;
  // Rates are known from the second reading on.
  for (bool is_first = true;; is_first = false) {
    const Result<client::Activity> activity = reader.read();
    // A server that restarts is back soon, but one that was never there may be mistyped.
    if (!activity.ok() && (is_first || arguments.once))
      return fail(status_of_answer(activity.error()), activity.error().message);
    if (is_screen) std::cout << kClearScreen;
    if (!activity.ok())
      std::cout << server << "  " << time_of_day() << "  " << activity.error().message << '\n';
    else if (is_screen || !is_first)
      std::cout << client::activity_text(*activity, server, time_of_day(),
                                         is_screen ? terminal_size() : client::TerminalSize{})
                << (is_screen || arguments.once ? "" : "\n");
    std::cout << std::flush;
    if (!std::cout || (arguments.once && !is_first)) return 0;
    if (!wait(arguments.interval_s, interrupts)) return 0;
  }
}

}  // namespace

Command add_top_command(CLI::App& app) {
  auto arguments = std::make_shared<TopArguments>();
  CLI::App& top = *app.add_subcommand(
      "top", "Show what a server is doing, again and again: running scans and waiting jobs");
  add_server_options(top, arguments->server)->required();
  top.add_option("--metrics", arguments->metrics,
                 "Address of the server's metrics (serve --admin-listen), such as "
                 "http://127.0.0.1:9464: show viewers, memory and latency, too");
  top.add_option("--interval", arguments->interval_s, "Seconds from one reading to the next")
      ->check(CLI::Range(0.5, 3600.0))
      ->capture_default_str();
  top.add_flag("--once", arguments->once, "Read twice, print once and end");
  return {&top, [arguments] { return run_top(*arguments); }};
}

}  // namespace hermite::commands
