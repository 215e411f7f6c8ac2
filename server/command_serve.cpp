// hermite serve
#include <fmt/core.h>
#include <malloc.h>
#include <spdlog/spdlog.h>
#include <sys/stat.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <system_error>

#include "core/dataset/text_file.h"
#include "server/commands.h"
#include "server/operations/logging.h"
#include "server/service/service.h"
#include "server/service/settings.h"
#include "server/service/settings_file.h"

namespace hermite::commands {

namespace {

struct ServeArguments {
  server::ServiceOptions defaults;
  std::string config;
  bool print_config = false;
  std::map<std::string, const CLI::Option*> flags;  // by setting
};

// Returns the folder next to an installed program, or else the one where the sources were built.
std::string default_web_folder() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path installed = program.parent_path().parent_path() / "share/hermite/web";
  if (!error && std::filesystem::exists(installed / "index.html", error)) return installed.string();
  return HERMITE_WEB_DIST;
}

void or_usage(const std::string& where, const Status& status) {
  if (!status.ok())
    throw SetupError({ErrorCode::kInvalidArgument, in_context(where, status.error()).message});
}

// Applies the file, then the environment, then the flags: later ones override earlier ones.
server::ServiceOptions options_of(const ServeArguments& arguments) {
  server::ServiceOptions options = arguments.defaults;
  if (!arguments.config.empty())
    or_usage(arguments.config,
             server::apply_config(options, or_throw(dataset::read_text_file(
                                               arguments.config, server::kMaxConfigBytes))));
  or_usage("the environment", server::apply_environment(options, environ));
  for (const auto& [key, flag] : arguments.flags) {
    if (flag->count() == 0) continue;
    or_usage("the command line", server::apply_setting(options, key, flag->results()));
  }
  or_usage("the settings", server::check(options));
  return options;
}

// glibc gives every thread its own arena, up to eight per processor, and never frees them: after
// some hundred small scans, each with its own threads, they held three times the memory in use
// (deploy/README.md). Nothing here allocates often enough for the locks of shared arenas to matter.
// MALLOC_ARENA_MAX in the environment overrides this.
void use_few_arenas() {
#ifdef __GLIBC__
  if (!std::getenv("MALLOC_ARENA_MAX")) mallopt(M_ARENA_MAX, 2);
#endif
}

int run_serve(const ServeArguments& arguments) {
  const server::ServiceOptions options = options_of(arguments);
  if (arguments.print_config) {
    std::cout << server::format_config(options, arguments.defaults);
    return 0;
  }
  const bool json =
      options.log_format == "json" || (options.log_format == "auto" && isatty(STDERR_FILENO) == 0);
  spdlog::set_default_logger(server::make_logger(
      std::cerr, json ? server::LogFormat::kJson : server::LogFormat::kText, options.log_level));
  umask(0077);  // files of the server are private, whichever library creates them
  use_few_arenas();
  server::Service service(options);
  // One line, for users to open and for scripts to read.
  std::cout << service.url() << (service.token_works() ? "/#token=" + service.token() : "/")
            << std::endl;
  if (!service.token_works())
    spdlog::info("the first token was revoked; `hermite token list` shows the others");
  spdlog::info("serving {}, data in {}", service.url(), options.data_folder);
  if (service.run()) return 0;
  // A worker is still inside the GPU driver and cannot be waited for; the results of all others are
  // written.
  spdlog::shutdown();
  std::_Exit(kFailed);
}

void add_flag(CLI::App& serve, const server::ServiceSetting& setting, ServeArguments& arguments) {
  std::string description =
      fmt::format("{} ({}default {})", setting.description,
                  setting.limits.empty() ? "" : setting.limits + "; ", setting.value);
  const std::string name = "--" + setting.key;
  CLI::Option* option = nullptr;
  if (setting.kind == server::SettingKind::kFlag)
    option = serve.add_flag(name)->description(description);
  else
    option = serve.add_option(name)->description(description);
  if (setting.kind == server::SettingKind::kList)
    option->expected(1, server::kMaxListEntries)->allow_extra_args(false);
  arguments.flags[setting.key] = option;
}

}  // namespace

std::string default_data_folder() {
  const char* const data_home = std::getenv("XDG_DATA_HOME");
  if (data_home && *data_home) return std::string(data_home) + "/hermite";
  const char* const home = std::getenv("HOME");
  return std::string(home && *home ? home : ".") + "/.local/share/hermite";
}

Command add_serve_command(CLI::App& app) {
  auto arguments = std::make_shared<ServeArguments>();
  arguments->defaults.data_folder = default_data_folder();
  arguments->defaults.web_folder = default_web_folder();
  CLI::App& serve =
      *app.add_subcommand("serve", "Take scans from cameras and show them in the browser");
  serve
      .add_option("--config", arguments->config, "File with settings, as --print-config prints it")
      ->envname("HERMITE_SERVE_CONFIG");
  serve.add_flag("--print-config", arguments->print_config,
                 "Print every setting as it would be used, as a file for --config, and end");
  for (const server::ServiceSetting& setting : server::list_settings(arguments->defaults))
    add_flag(serve, setting, *arguments);
  return {&serve, [arguments] { return run_serve(*arguments); }};
}

}  // namespace hermite::commands
