// hermite-client: streams recordings and cameras to a Hermite server, or uploads recordings, and
// fetches the results. Exit status: client_commands.h.
#include <CLI/CLI.hpp>

#include "server/client_commands.h"
#include "server/command_line.h"

int main(int argc, char** argv) {
  using namespace hermite::commands;
  CLI::App app("Streams RGB-D cameras and recordings to a Hermite server", "hermite-client");
  return run_command_line(app,
                          {add_scan_command(app), add_stream_command(app), add_load_command(app),
                           add_upload_command(app), add_import_command(app), add_jobs_command(app),
                           add_list_command(app), add_show_command(app), add_rename_command(app),
                           add_tag_command(app), add_stop_command(app), add_pause_command(app),
                           add_unpause_command(app), add_delete_command(app),
                           add_share_command(app), add_top_command(app), add_download_command(app)},
                          argc, argv);
}
