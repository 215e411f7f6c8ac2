// hermite serve
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <memory>
#include <system_error>

#include "server/commands.h"
#include "server/service/service.h"

namespace hermite {

namespace {

// Beside an installed program, else where the sources were built.
std::string default_web_folder() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path installed = program.parent_path().parent_path() / "share/hermite/web";
  if (!error && std::filesystem::exists(installed / "index.html", error)) return installed.string();
  return HERMITE_WEB_DIST;
}

int run_serve(const ServiceOptions& options) {
  spdlog::set_default_logger(spdlog::stderr_color_mt("hermite"));
  Service service(options);
  // One line, for people to open and for scripts to read.
  std::cout << service.url() << (service.token_works() ? "/#token=" + service.token() : "/") << std::endl;
  if (!service.token_works()) spdlog::info("the first token was revoked; `hermite token list` shows the others");
  spdlog::info("serving {}, data in {}", service.url(), options.data_folder);
  if (service.run()) return 0;
  // A worker is still inside the GPU driver and cannot be waited for; results of all others are written.
  spdlog::shutdown();
  std::_Exit(kFailed);
}

}  // namespace

std::string default_data_folder() {
  const char* const data_home = std::getenv("XDG_DATA_HOME");
  if (data_home && *data_home) return std::string(data_home) + "/hermite";
  const char* const home = std::getenv("HOME");
  return std::string(home && *home ? home : ".") + "/.local/share/hermite";
}

Command add_serve_command(CLI::App& app) {
  auto options = std::make_shared<ServiceOptions>();
  options->data_folder = default_data_folder();
  options->web_folder = default_web_folder();
  CLI::App& serve = *app.add_subcommand("serve", "Take scans from cameras and show them in the browser");
  serve.add_option("--listen", options->listen, "IP:PORT; port 0 takes any free one")->capture_default_str();
  serve.add_option("--data", options->data_folder, "Folder for scans, database and token")->capture_default_str();
  serve.add_option("--device", options->device, "GPU: an index or a part of its name (default: the best one)");
  serve.add_option("--web-dir", options->web_folder, "The viewer's files")->capture_default_str();
  serve.add_option("--max-scans", options->max_scans, "Scans running at once")->capture_default_str();
  serve.add_option("--credit-window", options->credit_window, "Frames a camera may send ahead of the reconstruction")
      ->capture_default_str();
  serve
      .add_option("--gpu-memory", options->gpu_memory_mb,
                  "Device memory for all scans together [MB], an equal share each; 0: as much as there is")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  serve.add_option("--allow-host", options->allow_hosts, "Another name that this server is reached by; may be repeated")
      ->allow_extra_args(false);
  Limits& limits = options->limits;
  serve.add_option("--max-connections", limits.connections, "Connections open at once")->capture_default_str();
  serve.add_option("--connections-per-address", limits.connections_per_address, "The same of one address")->capture_default_str();
  serve.add_option("--requests-per-second", limits.requests_per_second, "HTTP requests of one address")->capture_default_str();
  serve.add_option("--failures-per-minute", limits.failures_per_minute, "Wrong tokens of one address")->capture_default_str();
  serve.add_option("--scans-per-token", limits.scans_per_token, "Scans running at once of one token without the scope admin")
      ->capture_default_str();
  serve.add_option("--storage-gb", limits.storage_gb, "For the files of all scans [GB]; 0: as much as there is")->capture_default_str();
  serve.add_flag("--insecure-i-know", options->insecure_listen, "Listen on other addresses than the loopback's, without encryption");
  return {&serve, [options] { return run_serve(*options); }};
}

}  // namespace hermite
