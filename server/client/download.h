// Downloads an export of a scan: requests it, waits until it is made, and downloads it piece by
// piece, each over its own connection, so that an interruption costs only a piece. Blocks.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/client/server_url.h"
#include "server/net/tls.h"

namespace hermite::client {

struct DownloadTarget {
  ServerUrl server;        // with its token
  server::TlsContext tls;  // nullptr: not encrypted
  std::string scan_id;
  std::string format;
  // How long to retry while the server is unreachable or busy.
  std::chrono::milliseconds patience{600'000};
  std::uint64_t piece_bytes = 8 * 1024 * 1024;  // less than kMaxApiAnswerBytes
};

struct ExportReport {
  std::string format, label, file, state, message;
  double done = 0;
  std::uint64_t size_bytes = 0;
};

// Called on the thread of download(); each may be empty.
struct DownloadObserver {
  std::function<void(const ExportReport&)> on_state;  // while it is made
  std::function<void(std::uint64_t come_bytes, std::uint64_t total_bytes)> on_progress;
  std::function<bool()> interrupted;  // true: abort
};

// Returns the exports of the scan as listed by the server. Refusals as refusal(); kIo.
Result<std::vector<ExportReport>> export_reports(const DownloadTarget& target);

// Writes the export to `path`, completely or not at all, replacing an existing file. kIo also if it
// cannot be made, with the server's message, or is interrupted.
Status download(const DownloadTarget& target, const std::string& path,
                const DownloadObserver& observer);

}  // namespace hermite::client
