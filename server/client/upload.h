// Sends a recording to a server by tus, whatever happens to the link or the server meanwhile, and waits for the job that it becomes.
// Blocks.
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

namespace hermite {

// What is sent: a file as it is, or a folder as a tar (core/archive/tar_stream.h). Copies read the same files.
struct ByteSource {
  std::int64_t size_bytes = 0;
  std::string fingerprint;  // changes when the files do
  std::function<Result<std::string>(std::int64_t offset, std::int64_t count)> read;
};
Result<ByteSource> open_bytes(const std::string& path);  // kNotFound, and as TarStream

struct UploadTarget {
  ServerUrl server;                             // with its token
  TlsContext tls;                               // none: not encrypted
  std::string notes_folder;                     // where an upload's address is kept, so that another run goes on with it; empty: nowhere
  std::chrono::milliseconds patience{600'000};  // so long a server that is away or full is asked again
  std::int64_t piece_bytes = 4 * 1024 * 1024;   // each has its checksum
};

using UploadMetadata = std::vector<std::pair<std::string, std::string>>;  // "filename", "title", "camera", "settings", "priority"

// Called on the thread of upload(); each may be empty.
struct UploadObserver {
  std::function<void(std::int64_t sent_bytes, std::int64_t total_bytes)> on_progress;  // all of it durable there
  std::function<void(const std::string& words)> on_link;                               // away, back, full; or an old upload goes on
  std::function<bool()> interrupted;                                                   // true: give up; a later run goes on
};

// The id of the job. The server's refusals as refusal() has them (kBusy when it stayed full); kIo: it stayed away, the source has changed,
// or interrupted.
Result<std::string> upload(const ByteSource& source, const UploadMetadata& metadata, const UploadTarget& target,
                           const UploadObserver& observer);

struct JobReport {
  std::string id, title, state, stage, words, scan;
  std::int64_t done = 0, total = 0;
  bool ended() const { return state == "finished" || state == "failed" || state == "cancelled"; }
};

// kNotFound, and as http_exchange().
Result<JobReport> job_report(const UploadTarget& target, const std::string& id);
Result<std::vector<JobReport>> job_reports(const UploadTarget& target);                       // newest first
Result<JobReport> change_job(const UploadTarget& target, const std::string& id, bool retry);  // else it is cancelled
Result<JobReport> wait_for_job(const UploadTarget& target, const std::string& id, const std::function<bool(const JobReport&)>& go_on);

}  // namespace hermite
