// What a server remembers besides files: one row a scan, a token, an upload and a job. Rows outlive the server. Kept in SQLite
// (sqlite_store.h) or, some day, in PostgreSQL; what every implementation keeps is in tests/server/store/store_contract.h.
//
// What an implementation owes:
//   atomic    Each call is one transaction. What returns an error has changed nothing (after kIo: for this process; whether the change is
//             there after a restart is open where the disk has failed to sync it); a limit or a key that is checked is checked and
//             used at once. Nothing spans two calls: who needs two rows to agree writes them in an order that a death in between does no
//             harm to (an upload's job has the upload's id, so that it is added once however often that is tried).
//   durable   A change that returned well survives the death of the process, and that of the machine if its disk keeps its word.
//   in order  A call sees all that earlier calls have changed, and no part of a later one.
//   one user  Belongs to one thread at a time, and one server uses a store at a time. check_integrity() alone may be called from another
//             thread beside the others.
//
// Errors, where nothing else is said: kIo, with the words of the database, for everything that it does not do. Ids and secrets are told
// apart byte by byte.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/store/job_row.h"
#include "server/store/measurement_row.h"
#include "server/store/scan_row.h"
#include "server/store/shares.h"
#include "server/store/token_row.h"
#include "server/store/upload_row.h"

namespace hermite {

inline constexpr int kMaxListedScans = 1000;
inline constexpr int kMaxListedJobs = 1000;
inline constexpr int kMaxJobLines = 200;  // of one job; more are left out

class Store {
 public:
  virtual ~Store() = default;

  // kInvalidArgument: the id is there already.
  virtual Status add(const ScanRow& row) = 0;

  // Everything but id, title, camera, token_id and created_at_ms. kNotFound: no such scan.
  virtual Status update(const ScanRow& row) = 0;

  // The title alone. kNotFound: no such scan.
  virtual Status rename(const std::string& id, const std::string& title) = 0;

  // kNotFound: no such scan.
  virtual Result<ScanRow> find(const std::string& id) = 0;
  virtual Status remove(const std::string& id) = 0;  // its share links and measurements go with it

  // Newest first, at most kMaxListedScans: the newest, or those next to this one. kNotFound: no such scan.
  virtual Result<std::vector<ScanRow>> list() = 0;
  virtual Result<std::vector<ScanRow>> list_older_than(const std::string& id) = 0;

  // All that have not ended, oldest first; after a start: those that a dead server left. Without those of jobs that have not ended: the
  // job goes on with its scan.
  virtual Result<std::vector<ScanRow>> running() = 0;

  // The oldest of those that have ended and are to be rebuilt, if there is one.
  virtual Result<std::optional<ScanRow>> next_to_rebuild() = 0;

  // The ids of all scans of a token, whatever their state.
  virtual Result<std::vector<std::string>> scans_of_token(const std::string& token_id) = 0;

  // Whether the database would take a change now; makes none.
  virtual Status writable() = 0;

  // Reads all of it. kCorruptData: what is there is damaged, in words; kIo: that cannot be told now. May take long.
  virtual Status check_integrity() const = 0;

  // Tokens and share links. Those that have ended count for no limit and stay in the list until they are forgotten, or until so many of
  // the same maker have ended after them. What is kept of a limit for administrators (shares.h) is for a maker whose row may administer, or
  // who is empty: that is the owner of the data folder.
  // kInvalidArgument: the id or the secret is there already. kNotFound: no such scan. kBusy: the share of the maker is used up. The row's
  // created_at_ms says what the time is.
  virtual Status add_token(const TokenRow& row) = 0;
  virtual Result<TokenRow> find_token(const std::string& secret_sha256) = 0;    // kNotFound; also the revoked and the expired
  virtual Result<TokenRow> token(const std::string& id) = 0;                    // kNotFound
  virtual Result<std::vector<TokenRow>> list_tokens() = 0;                      // newest first
  virtual Status revoke_token(const std::string& id, std::int64_t now_ms) = 0;  // the first time stays. kNotFound
  virtual Status touch_token(const std::string& id, std::int64_t now_ms) = 0;   // last use. kNotFound
  virtual Status remove_token(const std::string& id) = 0;                       // kNotFound
  // Removes those revoked or expired before that time, but not the first token. How many.
  virtual Result<int> forget_tokens(std::int64_t ended_before_ms) = 0;

  // Uploads. kBusy: the share of its token is used up. kInvalidArgument: the id is there already. kNotFound.
  virtual Status add_upload(const UploadRow& row) = 0;
  virtual Status update_upload(const UploadRow& row) = 0;  // length, unchecked_from and expires_at_ms
  virtual Result<UploadRow> upload(const std::string& id) = 0;
  virtual Result<std::vector<UploadRow>> list_uploads() = 0;  // oldest first
  virtual Status remove_upload(const std::string& id) = 0;

  // Measurements of a scan, at most kMaxMeasurementsPerScan. kNotFound: no such scan; kBusy: it has as many already; kInvalidArgument: the
  // id is there already, the kind is none, or a number is none.
  virtual Status add_measurement(const MeasurementRow& row) = 0;
  virtual Result<std::vector<MeasurementRow>> list_measurements(const std::string& scan_id) = 0;  // oldest first; empty: it has none
  virtual Status remove_measurement(const std::string& scan_id, const std::string& id) = 0;       // kNotFound: it has no such one

  // Jobs. kBusy: the share of its token is used up, also for one that had ended and is to wait again. kInvalidArgument: the id is there
  // already. kNotFound. Of those that have ended the newest of each token stay.
  virtual Status add_job(const JobRow& row) = 0;
  virtual Status update_job(const JobRow& row) = 0;  // state, words, attempt_count, scan_id, started_at_ms and finished_at_ms
  virtual Result<JobRow> job(const std::string& id) = 0;
  virtual Result<std::vector<JobRow>> list_jobs() = 0;              // newest first, at most kMaxListedJobs
  virtual Result<std::vector<JobRow>> jobs_in(JobState state) = 0;  // the next one first
  virtual Result<std::map<JobState, int>> count_jobs() = 0;         // those that are remembered, of every state
  virtual Status add_job_line(const std::string& id, const JobLine& line) = 0;
  virtual Result<std::vector<JobLine>> job_lines(const std::string& id) = 0;
  virtual Result<int> forget_jobs(std::int64_t ended_before_ms) = 0;  // with their lines. How many
};

}  // namespace hermite
