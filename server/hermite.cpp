// hermite: the scanning server, and the same reconstruction without a server.
#include <CLI/CLI.hpp>

#include "server/command_line.h"

int main(int argc, char** argv) {
  using namespace hermite::commands;
  CLI::App app("Hermite: self-hosted 3D scanning with HRBF-Fusion", "hermite");
  return run_command_line(
      app,
      {add_serve_command(app), add_reconstruct_command(app), add_calibrate_command(app),
       add_evaluate_command(app), add_compare_command(app), add_inspect_command(app),
       add_convert_command(app), add_mesh_command(app), add_measure_command(app),
       add_export_command(app), add_doctor_command(app), add_backup_command(app),
       add_restore_command(app), add_migrate_command(app), add_token_command(app),
       add_share_command(app), add_audit_command(app), add_work_command(app)},
      argc, argv);
}
