// hermite-client: streams recordings and cameras to a Hermite server, or uploads recordings, and takes what came of them. Exit status:
// client_commands.h.
#include <CLI/CLI.hpp>
#include <iostream>
#include <vector>

#include "server/client_commands.h"

int main(int argc, char** argv) {
  using namespace hermite;
  CLI::App app("Streams RGB-D cameras and recordings to a Hermite server");
  app.require_subcommand(1);
  const std::vector<Command> commands{add_scan_command(app),   add_stream_command(app), add_upload_command(app),
                                      add_import_command(app), add_jobs_command(app),   add_download_command(app)};
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsage;
  }
  for (const Command& command : commands) {
    if (!command.app->parsed()) continue;
    try {
      return command.run();
    } catch (const SetupError& error) {
      return fail(kFailed, error.what());
    }
  }
  return kUsage;
}
