// hermite backup, hermite restore
#include <CLI/CLI.hpp>
#include <iostream>
#include <memory>

#include "server/commands.h"
#include "server/store/backup.h"

namespace hermite::commands {

namespace {

struct BackupArguments {
  std::string data = default_data_folder();
  std::string backup;
};

int print(const char* done, const std::string& where,
          const Result<server::BackupSummary>& summary) {
  if (!summary.ok()) throw SetupError(summary.error());
  std::cout << done << ' ' << where << ": " << summary->scan_count << " scans, "
            << summary->file_count << " files, " << summary->bytes / 1'000'000
            << " MB. It holds the access token: keep it private.\n";
  return 0;
}

}  // namespace

Command add_backup_command(CLI::App& app) {
  auto arguments = std::make_shared<BackupArguments>();
  CLI::App& backup = *app.add_subcommand(
      "backup", "Copy a server's scans, database and token; the server may run");
  backup.add_option("--data", arguments->data, "The server's data folder")->capture_default_str();
  backup.add_option("--to", arguments->backup, "Folder for the copy, which must not be there yet")
      ->required();
  return {&backup, [arguments] {
            return print("backed up into", arguments->backup,
                         server::back_up(arguments->data, arguments->backup));
          }};
}

Command add_restore_command(CLI::App& app) {
  auto arguments = std::make_shared<BackupArguments>();
  CLI::App& command = *app.add_subcommand(
      "restore", "Put a backup into an empty data folder, before a server is started with it");
  command.add_option("--from", arguments->backup, "Folder that `hermite backup` made")->required();
  command.add_option("--data", arguments->data, "Data folder, empty or not there yet")
      ->capture_default_str();
  return {&command, [arguments] {
            return print("restored into", arguments->data,
                         server::restore(arguments->backup, arguments->data));
          }};
}

}  // namespace hermite::commands
