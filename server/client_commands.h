// What the subcommands of `hermite-client` share: options for the server and for streams, messages,
// exit statuses and interrupts. Exit status: 0 success, 1 the scan or the connection failed, 2
// usage, and for uploads those below (README.md).
#pragma once

#include <chrono>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/client/scans.h"
#include "server/client/server_url.h"
#include "server/client/stream.h"
#include "server/commands.h"

namespace CLI {
class Option;
}

namespace hermite::commands {

inline constexpr int kUnusable = 3;   // a recording was not sent: it is invalid or damaged
inline constexpr int kJobFailed = 4;  // the job of an upload failed
inline constexpr int kRefused = 5;    // the server refused: token, limits, space

struct ServerArguments {
  std::string server;
  std::string token;
  std::string ca;
};

// A scan that is streamed to a server frame by frame.
struct StreamTarget {
  ServerArguments server;
  std::string report_path;
  std::optional<std::string> title;
  std::vector<std::string> settings;
};

// Return the option --server, which the caller may make mandatory.
CLI::Option* add_server_options(CLI::App& command, ServerArguments& arguments);
CLI::Option* add_stream_options(CLI::App& command, StreamTarget& target);

// kInvalidArgument, naming the option.
Result<client::ServerUrl> server_of(const ServerArguments& arguments);
// As server_of(), and kIo: --ca cannot be read.
Result<client::ApiTarget> api_target_of(const ServerArguments& arguments);
Result<std::map<std::string, std::string>> parse_settings(const std::vector<std::string>& texts);
// `name` is the title if none is given.
Result<client::StreamRequest> make_stream_request(const StreamTarget& target,
                                                  const std::string& name);

// Returns the exit status for a failed request: kRefused if the server refused it, otherwise
// kFailed.
int status_of_answer(const Error& error);

// Prints to stderr; returns `exit_status`.
int fail(int exit_status, const std::string& message);

// Prints the report to stdout and writes it to --report. Returns the exit status.
int print_report(const std::string& report_json, const StreamTarget& target);

// From now on SIGINT and SIGTERM are counted and do not end the program.
void count_interrupts();

// Returns 0, or 1 after an interrupt, or 2 after a further one. Signals within a second of the
// first count as the same one, since wrappers pass on what the terminal has sent to all processes
// already. Thread-safe.
class InterruptCounter {
 public:
  int count();

 private:
  std::mutex mutex_;
  std::optional<std::chrono::steady_clock::time_point> first_;
  int first_wish_ = 1;
};

Command add_stream_command(CLI::App& app);
Command add_load_command(CLI::App& app);
Command add_scan_command(CLI::App& app);
Command add_upload_command(CLI::App& app);
Command add_import_command(CLI::App& app);
Command add_jobs_command(CLI::App& app);
Command add_download_command(CLI::App& app);
Command add_list_command(CLI::App& app);
Command add_show_command(CLI::App& app);
Command add_rename_command(CLI::App& app);
Command add_tag_command(CLI::App& app);
Command add_stop_command(CLI::App& app);
Command add_pause_command(CLI::App& app);
Command add_unpause_command(CLI::App& app);
Command add_delete_command(CLI::App& app);
Command add_share_command(CLI::App& app);
Command add_top_command(CLI::App& app);

}  // namespace hermite::commands
