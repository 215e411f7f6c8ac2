// hermite: the scanning server, and the same reconstruction without a server.
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <vector>

#include "core/base/result.h"
#include "server/commands.h"

int main(int argc, char** argv) {
  using namespace hermite;
  CLI::App app("Hermite: self-hosted 3D scanning with HRBF-Fusion");
  app.require_subcommand(1);
  const std::vector<Command> commands = {add_serve_command(app),    add_reconstruct_command(app), add_calibrate_command(app),
                                         add_evaluate_command(app), add_inspect_command(app),     add_convert_command(app),
                                         add_mesh_command(app),     add_export_command(app),      add_doctor_command(app),
                                         add_backup_command(app),   add_restore_command(app),     add_token_command(app),
                                         add_share_command(app),    add_audit_command(app)};
  try {
    app.parse(argc, argv);
    for (const Command& command : commands)
      if (command.app->parsed()) return command.run();
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kUsage;
  } catch (const SetupError& error) {
    std::cerr << "hermite: " << error.what() << '\n';
    return error.error().code == ErrorCode::kInvalidArgument ? kUsage : kFailed;
  } catch (const std::exception& error) {
    std::cerr << "hermite: " << error.what() << '\n';
    return kFailed;
  }
  return kUsage;
}
