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
#include "server/s3/migrate.h"
#include "server/scan/checkpoint_file.h"
#include "server/service/results_place.h"
#include "server/service/settings.h"

namespace hermite {

namespace {

struct MigrateArguments {
  std::string from, to, config;
  ServiceOptions options;  // of which those of S3 are used
};

bool is_s3(const std::string& place) { return place.rfind("s3://", 0) == 0; }

ServiceOptions migrate_options(const MigrateArguments& arguments) {
  ServiceOptions options;
  if (!arguments.config.empty()) {
    const Status applied = apply_config(options, or_throw(read_text_file(arguments.config, kMaxConfigBytes)));
    if (!applied.ok()) throw SetupError(in_context(arguments.config, applied.error()));
  }
  if (const Status applied = apply_environment(options, environ); !applied.ok())
    throw SetupError(in_context("the environment", applied.error()));
  const ServiceOptions& given = arguments.options;
  const ServiceOptions standard;
  for (std::string ServiceOptions::*field : {&ServiceOptions::s3_endpoint, &ServiceOptions::s3_region, &ServiceOptions::s3_addressing,
                                             &ServiceOptions::s3_ca, &ServiceOptions::s3_credentials})
    if (given.*field != standard.*field) options.*field = given.*field;
  options.insecure_listen = options.insecure_listen || given.insecure_listen;
  options.blobs = is_s3(arguments.to) ? arguments.to : arguments.from;
  return options;
}

int run_migrate(const MigrateArguments& arguments) {
  if (is_s3(arguments.from) == is_s3(arguments.to))
    throw SetupError(
        {ErrorCode::kInvalidArgument, "one of --from and --to must be s3://BUCKET/PREFIX, and the other one a folder of data"});
  const std::string& folder = is_s3(arguments.from) ? arguments.to : arguments.from;
  std::error_code error;
  if (!std::filesystem::is_regular_file(folder + "/hermite.db", error))
    throw SetupError({ErrorCode::kNotFound, folder + " is no folder of data: it has no hermite.db"});
  S3Blobs s3(or_throw(s3_options(s3_settings(migrate_options(arguments)))));
  const DataDirectory data(folder);  // which no server uses meanwhile
  FileBlobs files(data.scans_folder());
  if (const Status allowed = s3.check_access(); !allowed.ok()) throw SetupError(allowed.error());
  const bool tell = isatty(STDERR_FILENO) != 0;
  const Migration migration{
      folder, files, s3, or_throw(data.scan_ids()), {kCheckpointName}, folder + "/blob-removals", [tell](const std::string& message) {
        if (tell) std::cerr << message << "\n";
      }};
  const MigrationCounts counts = or_throw(is_s3(arguments.to) ? migrate_to_s3(migration) : migrate_from_s3(migration));
  std::cout << "moved to " << arguments.to << ": " << counts.blob_count << " files, " << counts.bytes / 1'000'000
            << " MB, each compared by its SHA-256; " << counts.copied_count << " were copied now\n";
  if (is_s3(arguments.to)) std::cout << "start the server with --blobs " << s3.address() << " from now on\n";
  return 0;
}

}  // namespace

Command add_migrate_command(CLI::App& app) {
  auto arguments = std::make_shared<MigrateArguments>();
  ServiceOptions& options = arguments->options;
  CLI::App& migrate = *app.add_subcommand("migrate", "Move the results of a folder of data to S3, or back; no server may run on it");
  migrate.add_option("--from", arguments->from, "Folder of data, or s3://BUCKET/PREFIX")->required();
  migrate.add_option("--to", arguments->to, "The other one of the two")->required();
  migrate.add_option("--config", arguments->config, "File with settings of `hermite serve`, of which those of S3 are used");
  migrate.add_option("--s3-endpoint", options.s3_endpoint, "As of `hermite serve`");
  migrate.add_option("--s3-region", options.s3_region, "As of `hermite serve`");
  migrate.add_option("--s3-addressing", options.s3_addressing, "As of `hermite serve`");
  migrate.add_option("--s3-ca", options.s3_ca, "As of `hermite serve`");
  migrate.add_option("--s3-credentials", options.s3_credentials, "As of `hermite serve`");
  migrate.add_flag("--insecure-i-know", options.insecure_listen, "Allow an S3 server without TLS on another machine");
  return {&migrate, [arguments] { return run_migrate(*arguments); }};
}

}  // namespace hermite
