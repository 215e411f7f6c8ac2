// Manages the scans of a server from a terminal: lists, shows, renames, ends, deletes and shares
// them. Every function makes one request or, for a long list, several, and blocks until the answer
// has arrived.
//
// Errors of all functions are those of http_exchange() and, with the server's message, those of
// refusal(); kIo also if the answer is not a JSON object with the expected members.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/client/server_url.h"
#include "server/net/tls.h"

namespace hermite::client {

struct ApiTarget {
  ServerUrl server;        // with its token
  server::TlsContext tls;  // nullptr: not encrypted
};

// A scan as the server describes it. Times are UTC texts like "2024-05-01T12:00:00.123Z", empty for
// never.
struct ScanSummary {
  std::string id, title;
  std::vector<std::string> tags;
  std::string state;    // running, finished, failed or interrupted
  std::string message;  // why it ended that way; may be empty
  std::string created_at, finished_at;
  std::int64_t frames_received = 0, frames_processed = 0, frames_dropped = 0;
  std::int64_t width_px = 0, height_px = 0;
  std::string json;  // the server's object, on one line
};

struct ShareSummary {
  std::string id, scan, name;
  std::string state;  // active, expired or revoked
  std::string expires_at;
  std::string json;
};

// Returns all scans that the token may see, newest first, at most `at_most` of them.
Result<std::vector<ScanSummary>> list_scans(const ApiTarget& target, std::size_t at_most);
Result<ScanSummary> show_scan(const ApiTarget& target, const std::string& scan_id);

// Returns the scan with these tags instead of those it had. kInvalidArgument: the server's limits.
Result<ScanSummary> tag_scan(const ApiTarget& target, const std::string& scan_id,
                             const std::vector<std::string>& tags);

// Returns the scan with its new title. kInvalidArgument: the server accepts 1 to 200 bytes without
// control characters.
Result<ScanSummary> rename_scan(const ApiTarget& target, const std::string& scan_id,
                                const std::string& title);

// Ends a running scan, which keeps what it has. kBusy: it has ended already, or a job makes it.
Status stop_scan(const ApiTarget& target, const std::string& scan_id);

// Asks the camera of a running scan to pause, or to go on. kBusy: it does not run, or its camera is
// away or cannot be asked.
Status pause_scan(const ApiTarget& target, const std::string& scan_id, bool paused);

// Deletes a scan with all of its files, which needs the scope admin.
Status delete_scan(const ApiTarget& target, const std::string& scan_id);

// Returns the link with its secret, which the server reveals only this once. `days`: until it
// expires, 0 for the server's default.
Result<std::string> share_scan(const ApiTarget& target, const std::string& scan_id,
                               const std::string& name, int days);

// Returns the share links of a scan, or of all scans if `scan_id` is empty.
Result<std::vector<ShareSummary>> list_shares(const ApiTarget& target, const std::string& scan_id);
Status revoke_share(const ApiTarget& target, const std::string& share_id);

}  // namespace hermite::client
