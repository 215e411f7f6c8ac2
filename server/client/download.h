// Takes an export of a scan from a server: asks for it, waits until it is made, and takes it piece by piece, each over a connection of its
// own, so that a link that breaks costs a piece. Blocks.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/client/server_url.h"
#include "server/net/tls.h"

namespace hermite {

struct DownloadTarget {
  ServerUrl server;  // with its token
  TlsContext tls;    // none: not encrypted
  std::string scan_id;
  std::string format;
  std::chrono::milliseconds patience{600'000};  // so long a server that is away or full is asked again
  std::uint64_t piece_bytes = 8 * 1024 * 1024;  // less than kMaxApiAnswerBytes
};

struct ExportReport {
  std::string format, label, file, state, words;
  double done = 0;
  std::uint64_t size_bytes = 0;
};

// Called on the thread of download(); each may be empty.
struct DownloadObserver {
  std::function<void(const ExportReport&)> on_state;  // while it is made
  std::function<void(std::uint64_t come_bytes, std::uint64_t total_bytes)> on_progress;
  std::function<bool()> interrupted;  // true: give up
};

// As the server lists them. Refusals as refusal() has them; kIo.
Result<std::vector<ExportReport>> export_reports(const DownloadTarget& target);

// Writes it to `path`, whole or not at all; what there was is replaced. kIo also: it cannot be made, in the server's words, or interrupted.
Status download(const DownloadTarget& target, const std::string& path, const DownloadObserver& observer);

}  // namespace hermite
