// One row a scan, a token, an upload and a job, in SQLite. Rows outlive the server; the results themselves are files (data_directory.h).
//
// One connection, which is also the only one that writes checkpoints: SQLite 3.40 can lose a WAL that two connections reset. It belongs to
// one thread at a time. Failures of the database are kIo with SQLite's own words.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "core/math/camera.h"
#include "server/store/job_row.h"
#include "server/store/token_row.h"
#include "server/store/upload_row.h"

namespace hermite {

enum class ScanPhase { kRunning, kFinished, kFailed, kInterrupted };
const char* name_of(ScanPhase phase);  // "running", "finished", "failed", "interrupted"

struct ScanRow {
  std::string id;
  std::string title;
  ScanPhase phase = ScanPhase::kRunning;
  std::string words;  // why, when it failed or was interrupted
  Camera camera;
  std::int64_t frames_received = 0;
  std::int64_t frames_processed = 0;
  std::int64_t frames_dropped = 0;
  std::int64_t created_at_ms = 0;   // Unix time
  std::int64_t finished_at_ms = 0;  // 0 while running
};

inline constexpr int kMaxListedScans = 1000;
inline constexpr int kMaxTokens = 10'000;  // and share links, with those that have ended
inline constexpr int kMaxUploads = 1000;
inline constexpr int kMaxWaitingJobs = 1000;  // and running ones
inline constexpr int kMaxListedJobs = 1000;
inline constexpr int kMaxJobLines = 200;  // of one job; more are left out

class Store {
 public:
  // Opens or creates, and migrates an older schema after a backup (migrations.h). Throws SetupError in words: not a database, a damaged
  // one, one of another program, or one with a newer schema than this program knows (which is left untouched).
  explicit Store(const std::string& path);
  ~Store();
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;

  // kInvalidArgument: the id is there already.
  Status add(const ScanRow& row);

  // Everything but id, title, camera and created_at_ms. kNotFound: no such scan.
  Status update(const ScanRow& row);

  // kNotFound: no such scan.
  Result<ScanRow> find(const std::string& id);
  Status remove(const std::string& id);

  // Newest first, at most kMaxListedScans.
  Result<std::vector<ScanRow>> list();

  // All that have not ended; after a start: those that a dead server left. Without those of jobs that have not ended: the job goes on
  // with its scan.
  Result<std::vector<ScanRow>> running();

  // Whether the database would take a change now; makes none.
  Status writable();

  // Tokens and share links (store_tokens.cpp). Those that have ended stay in the list until they are forgotten.
  // kInvalidArgument: the id or the secret is there already. kNotFound: no such scan. kBusy: kMaxTokens.
  Status add_token(const TokenRow& row);
  Result<TokenRow> find_token(const std::string& secret_sha256);    // kNotFound; also the revoked and the expired
  Result<TokenRow> token(const std::string& id);                    // kNotFound
  Result<std::vector<TokenRow>> list_tokens();                      // newest first
  Status revoke_token(const std::string& id, std::int64_t now_ms);  // kNotFound
  Status touch_token(const std::string& id, std::int64_t now_ms);   // last use. kNotFound
  Status remove_token(const std::string& id);                       // kNotFound
  // Removes those revoked or expired before that time, but not the first token. How many.
  Result<int> forget_tokens(std::int64_t ended_before_ms);

  // Uploads (store_uploads.cpp). kBusy: kMaxUploads. kInvalidArgument: the id is there already. kNotFound.
  Status add_upload(const UploadRow& row);
  Status update_upload(const UploadRow& row);  // length, unchecked_from and expires_at_ms
  Result<UploadRow> upload(const std::string& id);
  Result<std::vector<UploadRow>> list_uploads();  // oldest first
  Status remove_upload(const std::string& id);

  // Jobs (store_jobs.cpp). kBusy: kMaxWaitingJobs. kInvalidArgument: the id is there already. kNotFound.
  Status add_job(const JobRow& row);
  Status update_job(const JobRow& row);  // state, words, attempt_count, scan_id, started_at_ms and finished_at_ms
  Result<JobRow> job(const std::string& id);
  Result<std::vector<JobRow>> list_jobs();              // newest first, at most kMaxListedJobs
  Result<std::vector<JobRow>> jobs_in(JobState state);  // the next one first
  Result<std::map<JobState, int>> count_jobs();         // those that are remembered, of every state
  Status add_job_line(const std::string& id, const JobLine& line);
  Result<std::vector<JobLine>> job_lines(const std::string& id);
  Result<int> forget_jobs(std::int64_t ended_before_ms);  // with their lines. How many

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite
