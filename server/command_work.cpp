// hermite work
#include <signal.h>

#include <CLI/CLI.hpp>
#include <atomic>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>

#include "core/dataset/text_file.h"
#include "server/commands.h"
#include "server/slurm/node_run.h"

namespace hermite::commands {

namespace {

constexpr int kToBeContinued = 75;  // EX_TEMPFAIL of sysexits.h

std::atomic<bool> told_to_leave = false;

// Slurm's number of this run: 0, and one more each time that the job was put back into its queue.
int run_number() {
  const char* const count = std::getenv("SLURM_RESTART_COUNT");
  return count ? static_cast<int>(dataset::parse_index(count).value_or(0)) : 0;
}

int run_work(const std::string& folder) {
  struct sigaction leave {};
  leave.sa_handler = [](int) { told_to_leave = true; };
  sigaction(SIGTERM, &leave, nullptr);
  sigaction(SIGINT, &leave, nullptr);
  const Result<server::NodeOutcome> outcome =
      server::run_on_node(folder, run_number(), told_to_leave);
  if (!outcome.ok()) throw SetupError(outcome.error());
  if (!outcome->words.empty()) std::cout << outcome->words << '\n';
  switch (outcome->end) {
    case server::NodeEnd::kFinished:
    case server::NodeEnd::kFailed: return 0;
    case server::NodeEnd::kStopped:
    case server::NodeEnd::kNoRoom: return kToBeContinued;
  }
  return kFailed;
}

}  // namespace

Command add_work_command(CLI::App& app) {
  auto folder = std::make_shared<std::string>();
  CLI::App& work = *app.add_subcommand(
      "work", "Do the work of a batch job on a node of a cluster; the server's jobs there call it");
  work.add_option("FOLDER", *folder, "Folder of an attempt, which the server has made")->required();
  work.footer(
      "The exit status is 0 if there is a result, or if the recording is at fault; 75 if the job "
      "is to go on elsewhere.");
  return {&work, [folder] { return run_work(*folder); }};
}

}  // namespace hermite::commands
