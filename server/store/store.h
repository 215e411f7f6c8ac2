// What a server stores besides files: one row per scan, token, upload, measurement, note and job. Rows outlive the
// server. Stored in SQLite (sqlite_store.h), perhaps some day in PostgreSQL; the tests in
// tests/server/store/store_contract.h apply to every implementation.
//
// Every implementation guarantees:
//   atomic    Each call is one transaction. A call that returns an error has changed nothing (after kIo: in this process;
//             if the disk failed to sync, the change may still appear after a restart). Limits and keys are checked in the
//             same transaction that uses them. No transaction spans two calls: rows that must agree are written in an order
//             in which a crash in between does no harm (the job of an upload has the id of the upload, so that it is added
//             only once however often that is tried).
//   durable   A change whose call succeeded survives the death of the process, and that of the machine if its disk honours
//             syncs.
//   in order  A call sees all changes of earlier calls, and none of later ones.
//   one user  A store belongs to one thread at a time, and to one server. Only check_integrity() may be called on another
//             thread meanwhile.
//
// Errors, unless stated otherwise: kIo with the message of the database for every failure. Ids and secrets are compared
// byte by byte.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/store/job_row.h"
#include "server/store/measurement_row.h"
#include "server/store/note_row.h"
#include "server/store/scan_row.h"
#include "server/store/shares.h"
#include "server/store/token_row.h"
#include "server/store/upload_row.h"

namespace hermite {

inline constexpr int kMaxListedScans = 1000;
inline constexpr int kMaxListedJobs = 1000;
inline constexpr int kMaxJobLines = 200;  // per job; further lines are dropped

class Store {
 public:
  virtual ~Store() = default;

  // kInvalidArgument: the id exists already.
  virtual Status add(const ScanRow& row) = 0;

  // Writes everything but id, title, camera, token_id and created_at_ms. kNotFound: no such scan.
  virtual Status update(const ScanRow& row) = 0;

  // Writes only the title. kNotFound: no such scan.
  virtual Status rename(const std::string& id, const std::string& title) = 0;

  // kNotFound: no such scan.
  virtual Result<ScanRow> find(const std::string& id) = 0;
  virtual Status remove(const std::string& id) = 0;  // with its share links, measurements and notes

  // Return scans newest first, at most kMaxListedScans: the newest ones, or those that follow the given one. kNotFound:
  // no such scan.
  virtual Result<std::vector<ScanRow>> list() = 0;
  virtual Result<std::vector<ScanRow>> list_older_than(const std::string& id) = 0;

  // Returns all scans that have not ended, oldest first; after a start these are the ones that the previous server
  // left. Leaves out scans of jobs that have not ended, since such a job continues with its scan.
  virtual Result<std::vector<ScanRow>> running() = 0;

  // Returns the oldest ended scan that is to be rebuilt; std::nullopt if there is none.
  virtual Result<std::optional<ScanRow>> next_to_rebuild() = 0;

  // Returns the ids of all scans of a token, in any state.
  virtual Result<std::vector<std::string>> scans_of_token(const std::string& token_id) = 0;

  // Returns whether the database accepts changes at the moment; makes none.
  virtual Status writable() = 0;

  // Reads the whole database, which may take long. kCorruptData: it is damaged, with a message; kIo: it cannot be checked
  // now.
  virtual Status check_integrity() const = 0;

  // Tokens and share links. Those that have ended count for no limit, and stay in the list until they are forgotten or
  // there are kMaxEndedLinksPerToken newer ended ones of the same creator. The part of a limit that is reserved for
  // administrators (shares.h) is available to a creator whose row has the scope admin, and to an empty one, which is
  // the owner of the data folder. kInvalidArgument: the id or the secret exists already. kNotFound: no such scan.
  // kBusy: the share of the creator is used up. The current time is taken from the row's created_at_ms.
  virtual Status add_token(const TokenRow& row) = 0;
  virtual Result<TokenRow> find_token(const std::string& secret_sha256) = 0;    // kNotFound; also returns revoked and expired ones
  virtual Result<TokenRow> token(const std::string& id) = 0;                    // kNotFound
  virtual Result<std::vector<TokenRow>> list_tokens() = 0;                      // newest first
  virtual Status revoke_token(const std::string& id, std::int64_t now_ms) = 0;  // keeps the time of the first revocation. kNotFound
  virtual Status touch_token(const std::string& id, std::int64_t now_ms) = 0;   // sets the last use. kNotFound
  virtual Status remove_token(const std::string& id) = 0;                       // kNotFound
  // Removes those revoked or expired before that time, except the first token. Returns their number.
  virtual Result<int> forget_tokens(std::int64_t ended_before_ms) = 0;

  // Uploads. kBusy: the share of its token is used up. kInvalidArgument: the id exists already. kNotFound.
  virtual Status add_upload(const UploadRow& row) = 0;
  virtual Status update_upload(const UploadRow& row) = 0;  // length, unchecked_from and expires_at_ms
  virtual Result<UploadRow> upload(const std::string& id) = 0;
  virtual Result<std::vector<UploadRow>> list_uploads() = 0;  // oldest first
  virtual Status remove_upload(const std::string& id) = 0;

  // Measurements of a scan, at most kMaxMeasurementsPerScan. kNotFound: no such scan. kBusy: it has that many already.
  // kInvalidArgument: the id exists already, the kind is invalid, a number is NaN, or the numbers of points and normals
  // differ.
  virtual Status add_measurement(const MeasurementRow& row) = 0;
  virtual Result<std::vector<MeasurementRow>> list_measurements(const std::string& scan_id) = 0;  // oldest first; empty if it has none
  // Removes a measurement. kNotFound: the scan has no such measurement.
  virtual Status remove_measurement(const std::string& scan_id, const std::string& id) = 0;

  // Jobs. kBusy: the share of its token is used up, also when an ended job is queued again. kInvalidArgument: the id
  // exists already. kNotFound. Of ended jobs, the newest of each token stay.
  virtual Status add_job(const JobRow& row) = 0;
  virtual Status update_job(const JobRow& row) = 0;  // state, message, attempt_count, scan_id, started_at_ms and finished_at_ms
  virtual Result<JobRow> job(const std::string& id) = 0;
  virtual Result<std::vector<JobRow>> list_jobs() = 0;              // newest first, at most kMaxListedJobs
  virtual Result<std::vector<JobRow>> jobs_in(JobState state) = 0;  // in the order in which they run
  virtual Result<std::map<JobState, int>> count_jobs() = 0;         // of stored jobs, by state
  virtual Status add_job_line(const std::string& id, const JobLine& line) = 0;
  virtual Result<std::vector<JobLine>> job_lines(const std::string& id) = 0;
  virtual Result<int> forget_jobs(std::int64_t ended_before_ms) = 0;  // with their lines. Returns their number

  // Notes in a scan, at most kMaxNotesPerScan. kNotFound: no such scan. kBusy: it has that many already.
  // kInvalidArgument: the id exists already, or a number is NaN.
  virtual Status add_note(const NoteRow& row) = 0;
  virtual Result<std::vector<NoteRow>> list_notes(const std::string& scan_id) = 0;  // oldest first; empty if it has none
  // Writes the text and changed_at_ms of `row` into the note if that has the version of `row`, which then grows by 1.
  // kNotFound: the scan has no such note.
  virtual Result<NoteOutcome> change_note(const NoteRow& row) = 0;
  // Removes a note if it has this version. kNotFound as above.
  virtual Result<NoteOutcome> remove_note(const std::string& scan_id, const std::string& id, std::int64_t version) = 0;
};

}  // namespace hermite
