// The store in one SQLite file. A change is on disk (synchronous = FULL) when its call returns.
//
// There is one connection, and no other runs WAL checkpoints: SQLite 3.40 can lose a WAL that two connections reset.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "server/store/store.h"

namespace hermite {

class SqliteStore : public Store {
 public:
  // Opens or creates the file, and migrates an older schema after a backup (migrations.h). Throws SetupError, with a message:
  // not a database, damaged, of another program, or with a newer schema than this program knows (left unchanged).
  explicit SqliteStore(const std::string& path);
  ~SqliteStore() override;
  SqliteStore(const SqliteStore&) = delete;
  SqliteStore& operator=(const SqliteStore&) = delete;

  Status add(const ScanRow& row) override;
  Status update(const ScanRow& row) override;
  Status rename(const std::string& id, const std::string& title) override;
  Result<ScanRow> find(const std::string& id) override;
  Status remove(const std::string& id) override;
  Result<std::vector<ScanRow>> list() override;
  Result<std::vector<ScanRow>> list_older_than(const std::string& id) override;
  Result<std::vector<ScanRow>> running() override;
  Result<std::optional<ScanRow>> next_to_rebuild() override;
  Result<std::vector<std::string>> scans_of_token(const std::string& token_id) override;
  Status writable() override;
  Status check_integrity() const override;  // uses its own connection, which only reads

  // In sqlite_store_tokens.cpp.
  Status add_token(const TokenRow& row) override;
  Result<TokenRow> find_token(const std::string& secret_sha256) override;
  Result<TokenRow> token(const std::string& id) override;
  Result<std::vector<TokenRow>> list_tokens() override;
  Status revoke_token(const std::string& id, std::int64_t now_ms) override;
  Status touch_token(const std::string& id, std::int64_t now_ms) override;
  Status remove_token(const std::string& id) override;
  Result<int> forget_tokens(std::int64_t ended_before_ms) override;

  // In sqlite_store_uploads.cpp.
  Status add_upload(const UploadRow& row) override;
  Status update_upload(const UploadRow& row) override;
  Result<UploadRow> upload(const std::string& id) override;
  Result<std::vector<UploadRow>> list_uploads() override;
  Status remove_upload(const std::string& id) override;

  // In sqlite_store_measurements.cpp.
  Status add_measurement(const MeasurementRow& row) override;
  Result<std::vector<MeasurementRow>> list_measurements(const std::string& scan_id) override;
  Status remove_measurement(const std::string& scan_id, const std::string& id) override;

  // In sqlite_store_jobs.cpp.
  Status add_job(const JobRow& row) override;
  Status update_job(const JobRow& row) override;
  Result<JobRow> job(const std::string& id) override;
  Result<std::vector<JobRow>> list_jobs() override;
  Result<std::vector<JobRow>> jobs_in(JobState state) override;
  Result<std::map<JobState, int>> count_jobs() override;
  Status add_job_line(const std::string& id, const JobLine& line) override;
  Result<std::vector<JobLine>> job_lines(const std::string& id) override;
  Result<int> forget_jobs(std::int64_t ended_before_ms) override;

  // In sqlite_store_notes.cpp.
  Status add_note(const NoteRow& row) override;
  Result<std::vector<NoteRow>> list_notes(const std::string& scan_id) override;
  Result<NoteOutcome> change_note(const NoteRow& row) override;
  Result<NoteOutcome> remove_note(const std::string& scan_id, const std::string& id, std::int64_t version) override;

 private:
  struct Impl;
  const std::string path_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace hermite
