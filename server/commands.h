// The subcommands of `hermite`: each function adds one to the command line and returns it with the
// function that runs it. Exit status: 0 success, 1 failure, 2 usage.
#pragma once

#include <functional>
#include <string>
#include <utility>

#include "core/base/result.h"

namespace CLI {
class App;
}

namespace hermite::commands {

inline constexpr int kFailed = 1;
inline constexpr int kUsage = 2;

// Runs the subcommand after the arguments were parsed. May throw SetupError, which main reports.
struct Command {
  CLI::App* app = nullptr;
  std::function<int()> run;
};

Command add_serve_command(CLI::App& app);
Command add_reconstruct_command(CLI::App& app);
Command add_work_command(CLI::App& app);
Command add_calibrate_command(CLI::App& app);
Command add_evaluate_command(CLI::App& app);
Command add_compare_command(CLI::App& app);
Command add_mesh_command(CLI::App& app);
Command add_measure_command(CLI::App& app);
Command add_inspect_command(CLI::App& app);
Command add_convert_command(CLI::App& app);
Command add_export_command(CLI::App& app);
Command add_doctor_command(CLI::App& app);
Command add_backup_command(CLI::App& app);
Command add_restore_command(CLI::App& app);
Command add_migrate_command(CLI::App& app);
Command add_audit_command(CLI::App& app);
Command add_token_command(CLI::App& app);
Command add_share_command(CLI::App& app);

// Returns $XDG_DATA_HOME/hermite, or ~/.local/share/hermite if that is not set.
std::string default_data_folder();

}  // namespace hermite::commands
