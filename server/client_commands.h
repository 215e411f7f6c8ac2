// What the subcommands of `hermite-client` share: where the server is, what to tell it, and when somebody wants an end. Exit status: 0
// well, 1 the scan or the connection failed, 2 usage, and of uploads those below (README.md).
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

namespace hermite {

inline constexpr int kUnusable = 3;   // a recording was not sent: it is none, or damaged
inline constexpr int kJobFailed = 4;  // what was sent came to nothing
inline constexpr int kRefused = 5;    // the server says no: token, limits, room

struct ServerArguments {
  std::string server;
  std::string token;
  std::string ca;
};

// A scan that goes to a server frame by frame.
struct StreamTarget {
  ServerArguments server;
  std::string report_path;
  std::optional<std::string> title;
  std::vector<std::string> settings;
};

// They return --server, which the caller may require.
CLI::Option* add_server_options(CLI::App& command, ServerArguments& arguments);
CLI::Option* add_stream_options(CLI::App& command, StreamTarget& target);

// kInvalidArgument, naming the option.
Result<ServerUrl> server_of(const ServerArguments& arguments);
Result<ApiTarget> api_target_of(const ServerArguments& arguments);  // also kIo: --ca cannot be read
Result<std::map<std::string, std::string>> parse_settings(const std::vector<std::string>& texts);
Result<StreamRequest> make_stream_request(const StreamTarget& target, const std::string& name);  // `name`: the title when none is given

// The exit status for what a request came to: kRefused where the server refused it, else kFailed.
int status_of_answer(const Error& error);

// To stderr; returns `exit_status`.
int fail(int exit_status, const std::string& words);

// The report to stdout and to --report. The exit status.
int print_report(const std::string& report_json, const StreamTarget& target);

// From now on SIGINT and SIGTERM are counted instead of ending the program.
void count_interrupts();

// 0, 1 or 2: whether somebody wants an end, and then whether somebody insists. Signals within a second of the first are the same wish:
// wrappers pass on what the terminal has sent to everyone already. Thread-safe.
class InterruptCounter {
 public:
  int count();

 private:
  std::mutex mutex_;
  std::optional<std::chrono::steady_clock::time_point> first_;
  int first_wish_ = 1;
};

Command add_stream_command(CLI::App& app);
Command add_scan_command(CLI::App& app);
Command add_upload_command(CLI::App& app);
Command add_import_command(CLI::App& app);
Command add_jobs_command(CLI::App& app);
Command add_download_command(CLI::App& app);
Command add_list_command(CLI::App& app);
Command add_show_command(CLI::App& app);
Command add_rename_command(CLI::App& app);
Command add_stop_command(CLI::App& app);
Command add_delete_command(CLI::App& app);
Command add_share_command(CLI::App& app);

}  // namespace hermite
