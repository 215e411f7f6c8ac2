// hermite migrate
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <memory>
#include <system_error>
#include <vector>

#include "core/dataset/text_file.h"
#include "server/commands.h"
#include "server/database/postgres_connection.h"
#include "server/s3/migrate.h"
#include "server/scan/checkpoint_file.h"
#include "server/service/results_place.h"
#include "server/service/settings.h"
#include "server/service/settings_file.h"
#include "server/store/rows_place.h"

namespace hermite::commands {

namespace {

struct MigrateArguments {
  std::string from, to, config;
  server::ServiceOptions options;  // of which those of S3 are used
};

bool is_s3(const std::string& place) { return place.rfind("s3://", 0) == 0; }
bool is_postgres(const std::string& place) {
  return place.rfind("postgres://", 0) == 0 || place.rfind("postgresql://", 0) == 0;
}
bool is_folder(const std::string& place) { return !is_s3(place) && !is_postgres(place); }

server::ServiceOptions migrate_options(const MigrateArguments& arguments) {
  server::ServiceOptions options;
  if (!arguments.config.empty()) {
    const Status applied = server::apply_config(
        options, or_throw(dataset::read_text_file(arguments.config, server::kMaxConfigBytes)));
    if (!applied.ok()) throw SetupError(in_context(arguments.config, applied.error()));
  }
  if (const Status applied = server::apply_environment(options, environ); !applied.ok())
    throw SetupError(in_context("the environment", applied.error()));
  const server::ServiceOptions& given = arguments.options;
  const server::ServiceOptions standard;
  for (std::string server::ServiceOptions::*field :
       {&server::ServiceOptions::s3_endpoint, &server::ServiceOptions::s3_region,
        &server::ServiceOptions::s3_addressing, &server::ServiceOptions::s3_ca,
        &server::ServiceOptions::s3_credentials})
    if (given.*field != standard.*field) options.*field = given.*field;
  options.insecure_listen = options.insecure_listen || given.insecure_listen;
  options.blobs = is_s3(arguments.to) ? arguments.to : arguments.from;
  return options;
}

// Rows, between a folder and PostgreSQL.
int move_rows(const std::string& folder, const MigrateArguments& arguments) {
  const std::string& address = is_folder(arguments.from) ? arguments.to : arguments.from;
  or_throw(server::check_postgres_url(address, migrate_options(arguments).insecure_listen));
  const server::DataDirectory data(folder);  // which no server uses meanwhile
  const bool leaves = is_folder(arguments.from);
  const server::CopySummary moved = or_throw(leaves ? server::move_rows_to_postgres(folder, address)
                                                    : server::move_rows_to_folder(folder, address));
  std::cout << "moved " << moved.row_count << " rows of " << moved.scan_count << " scans to "
            << arguments.to << ", each table compared by its SHA-256\n";
  if (leaves)
    std::cout << "a server on " << folder
              << " uses that database from now on; the file as it was is hermite.db.moved\n";
  return 0;
}

// Results, between a folder and S3.
int move_results(const std::string& folder, const MigrateArguments& arguments) {
  server::S3Blobs s3(or_throw(server::s3_options(server::s3_settings(migrate_options(arguments)))));
  const server::DataDirectory data(folder);  // which no server uses meanwhile
  server::FileBlobs files(data.scans_folder());
  if (const Status allowed = s3.check_access(); !allowed.ok()) throw SetupError(allowed.error());
  const bool tell = isatty(STDERR_FILENO) != 0;
  const server::Migration migration{folder,
                                    files,
                                    s3,
                                    or_throw(data.scan_ids()),
                                    {server::kCheckpointName},
                                    folder + "/blob-removals",
                                    [tell](const std::string& message) {
                                      if (tell) std::cerr << message << "\n";
                                    }};
  const server::MigrationCounts counts = or_throw(
      is_s3(arguments.to) ? server::migrate_to_s3(migration) : server::migrate_from_s3(migration));
  std::cout << "moved to " << arguments.to << ": " << counts.blob_count << " files, "
            << counts.bytes / 1'000'000 << " MB, each compared by its SHA-256; "
            << counts.copied_count << " were copied now\n";
  if (is_s3(arguments.to))
    std::cout << "start the server with --blobs " << s3.address() << " from now on\n";
  return 0;
}

int run_migrate(const MigrateArguments& arguments) {
  if (is_folder(arguments.from) == is_folder(arguments.to))
    throw SetupError(
        {ErrorCode::kInvalidArgument,
         "one of --from and --to must be a folder of data, and the other one s3://BUCKET/PREFIX or "
         "postgresql://USER@HOST/DATABASE"});
  const bool leaves = is_folder(arguments.from);
  const std::string &folder = leaves ? arguments.from : arguments.to,
                    &other = leaves ? arguments.to : arguments.from;
  std::error_code error;
  if (!std::filesystem::is_regular_file(folder + "/" + server::kRowsFile, error) &&
      !or_throw(server::are_rows_in_postgres(folder)))
    throw SetupError(
        {ErrorCode::kNotFound, folder + " is no folder of data: it has no hermite.db"});
  return is_s3(other) ? move_results(folder, arguments) : move_rows(folder, arguments);
}

}  // namespace

Command add_migrate_command(CLI::App& app) {
  auto arguments = std::make_shared<MigrateArguments>();
  server::ServiceOptions& options = arguments->options;
  CLI::App& migrate = *app.add_subcommand("migrate",
                                          "Move the results of a folder of data to S3, its rows to "
                                          "PostgreSQL, or either back; no server may run on it");
  migrate
      .add_option("--from", arguments->from,
                  "Folder of data, s3://BUCKET/PREFIX or postgresql://USER@HOST/DATABASE")
      ->required();
  migrate.add_option("--to", arguments->to, "The other one of the two")->required();
  migrate.add_option("--config", arguments->config,
                     "File with settings of `hermite serve`, of which those of S3 are used");
  migrate.add_option("--s3-endpoint", options.s3_endpoint, "As of `hermite serve`");
  migrate.add_option("--s3-region", options.s3_region, "As of `hermite serve`");
  migrate.add_option("--s3-addressing", options.s3_addressing, "As of `hermite serve`");
  migrate.add_option("--s3-ca", options.s3_ca, "As of `hermite serve`");
  migrate.add_option("--s3-credentials", options.s3_credentials, "As of `hermite serve`");
  migrate.add_flag("--insecure-i-know", options.insecure_listen,
                   "Allow an S3 server or a database on another machine without TLS");
  return {&migrate, [arguments] { return run_migrate(*arguments); }};
}

}  // namespace hermite::commands
