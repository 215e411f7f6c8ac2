// Logs lines to stderr: JSON objects for journald and log collectors, text for people. Uses spdlog;
// spdlog::info(...) and the like use this logger, too, once it is the default one.
//
//   {"ts":"2026-01-31T12:00:00.123Z","level":"info","msg":"...",
//    "session":"<scan id>","remote":"192.0.2.7","duration":1.25}
//
// The last three fields are present if known, `duration` in seconds. No token is logged: anything
// that looks like one (32 or more consecutive hex digits, or what follows "token=") is replaced. Of
// lines that differ only in digits and scan, kLinesPerWindow are logged per kLogWindow; the next
// one after that says how many were left out. Any thread.
#pragma once

#include <spdlog/logger.h>

#include <chrono>
#include <memory>
#include <optional>
#include <ostream>
#include <string>

namespace hermite::server {

inline constexpr std::chrono::milliseconds kLogWindow(2500);
inline constexpr int kLinesPerWindow = 5;

enum class LogFormat { kText, kJson };

// `level`: "debug", "info", "warn" or "error". `out` outlives the logger.
std::shared_ptr<spdlog::logger> make_logger(std::ostream& out, LogFormat format,
                                            const std::string& level);

struct LogFields {
  std::string session = {};  // id of the scan
  std::string remote = {};   // address of the client
  std::optional<double> duration_s = {};
};

// Logs a line with fields to the default logger.
void log_with(const LogFields& fields, spdlog::level::level_enum level, const std::string& message);

}  // namespace hermite::server
