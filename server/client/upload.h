// Uploads a recording to a server by tus, resuming after failures of the link or the server, and
// waits for the job that it becomes. Blocks.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/result.h"
#include "server/client/server_url.h"
#include "server/net/tls.h"

namespace hermite::client {

// The bytes to upload: a file as it is, or a folder as a tar archive (core/archive/tar_stream.h).
// Copies read the same files.
struct ByteSource {
  std::int64_t size_bytes = 0;
  std::string fingerprint;  // changes if the files do
  std::function<Result<std::string>(std::int64_t offset, std::int64_t count)> read;
};
Result<ByteSource> open_bytes(const std::string& path);  // kNotFound, and errors as TarStream

struct UploadTarget {
  ServerUrl server;        // with its token
  server::TlsContext tls;  // nullptr: not encrypted
  // Where the address of an upload is stored, so that another run can resume it; empty: nowhere.
  std::string notes_folder;
  // How long to retry while the server is unreachable or busy.
  std::chrono::milliseconds patience{600'000};
  std::int64_t piece_bytes = 4 * 1024 * 1024;  // each piece has its own checksum
};

// Keys "filename", "title", "camera", "settings", "priority".
using UploadMetadata = std::vector<std::pair<std::string, std::string>>;

// Called on the thread of upload(); each may be empty.
struct UploadObserver {
  // `sent_bytes` are durable on the server.
  std::function<void(std::int64_t sent_bytes, std::int64_t total_bytes)> on_progress;
  // Unreachable, reachable again, busy; or an earlier upload is resumed.
  std::function<void(const std::string& message)> on_link;
  std::function<bool()> interrupted;  // true: abort; a later run resumes
};

// Returns the id of the job. Refusals as refusal() (kBusy if the server stayed full); kIo: the
// server stayed unreachable, the source has changed, or interrupted.
Result<std::string> upload(const ByteSource& source, const UploadMetadata& metadata,
                           const UploadTarget& target, const UploadObserver& observer);

struct JobReport {
  std::string id, title, state, stage, message, scan;
  std::int64_t done = 0, total = 0;
  bool ended() const { return state == "finished" || state == "failed" || state == "cancelled"; }
};

// kNotFound, and errors as http_exchange().
Result<JobReport> job_report(const UploadTarget& target, const std::string& id);
Result<std::vector<JobReport>> job_reports(const UploadTarget& target);  // newest first
// Retries the job if `retry`, otherwise cancels it.
Result<JobReport> change_job(const UploadTarget& target, const std::string& id, bool retry);
Result<JobReport> wait_for_job(const UploadTarget& target, const std::string& id,
                               const std::function<bool(const JobReport&)>& go_on);

}  // namespace hermite::client
