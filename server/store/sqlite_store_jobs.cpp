// The part of SqliteStore for jobs.
#include <sqlite3.h>

#include "server/store/sqlite_connection.h"

namespace hermite {

namespace {

constexpr const char* kJobColumns =
    "id, token_id, title, source, source_id, settings, camera, priority, state, words, attempt_count, scan_id, created_at_ms, "
    "started_at_ms, finished_at_ms";

JobState state_of(const std::string& name) {
  for (const JobState state : kAllJobStates)
    if (name == name_of(state)) return state;
  return JobState::kFailed;
}

JobRow job_row_of(const SQLite::Statement& query) {
  JobRow row;
  row.id = query.getColumn(0).getString();
  row.token_id = query.getColumn(1).getString();
  row.title = query.getColumn(2).getString();
  row.source = query.getColumn(3).getString() == name_of(JobSource::kScan) ? JobSource::kScan : JobSource::kUpload;
  row.source_id = query.getColumn(4).getString();
  row.settings = query.getColumn(5).getString();
  row.camera = query.getColumn(6).getString();
  row.priority = query.getColumn(7).getInt();
  row.state = state_of(query.getColumn(8).getString());
  row.message = query.getColumn(9).getString();
  row.attempt_count = query.getColumn(10).getInt();
  row.scan_id = query.getColumn(11).getString();
  row.created_at_ms = query.getColumn(12).getInt64();
  row.started_at_ms = query.getColumn(13).getInt64();
  row.finished_at_ms = query.getColumn(14).getInt64();
  return row;
}

Error no_job(const std::string& id) { return {ErrorCode::kNotFound, "there is no job " + id}; }

// Checks whether a token may have one more job that is queued or running.
Status check_job_share(SQLite::Database& database, const std::string& token_id) {
  SQLite::Statement count(database, "SELECT count(*), coalesce(sum(token_id = ?1), 0) FROM jobs WHERE state IN ('queued', 'running')");
  const Taken taken = taken_of(count, token_id);
  return check_share(kJobShare, taken, may_administer(database, token_id), "jobs that wait or run");
}

// Keeps only the newest kMaxEndedJobsPerToken ended jobs of a token.
void forget_more_than_enough(SQLite::Database& database, const std::string& token_id) {
  SQLite::Statement change(database,
                           "DELETE FROM jobs WHERE id IN (SELECT id FROM jobs WHERE token_id = ?1 AND state NOT IN ('queued', 'running') "
                           "ORDER BY finished_at_ms DESC, id LIMIT -1 OFFSET ?2)");
  change.bind(1, token_id);
  change.bind(2, kMaxEndedJobsPerToken);
  change.exec();
}

}  // namespace

Status SqliteStore::add_job(const JobRow& row) try {
  SQLite::Database& database = impl_->database;
  SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
  if (!has_ended(row.state))
    if (Status status = check_job_share(database, row.token_id); !status.ok()) return status;
  SQLite::Statement insert(database, std::string("INSERT INTO jobs(") + kJobColumns + ") VALUES(?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  int column = 0;
  for (const std::string& text :
       {row.id, row.token_id, row.title, std::string(name_of(row.source)), row.source_id, row.settings, row.camera})
    insert.bind(++column, text);
  insert.bind(++column, row.priority);
  insert.bind(++column, std::string(name_of(row.state)));
  insert.bind(++column, row.message);
  insert.bind(++column, row.attempt_count);
  insert.bind(++column, row.scan_id);
  for (const std::int64_t time_ms : {row.created_at_ms, row.started_at_ms, row.finished_at_ms}) insert.bind(++column, time_ms);
  insert.exec();
  forget_more_than_enough(database, row.token_id);
  transaction.commit();
  return Done{};
} catch (const SQLite::Exception& failure) {
  if (failure.getErrorCode() == SQLITE_CONSTRAINT) return Error{ErrorCode::kInvalidArgument, "job " + row.id + ": " + failure.what()};
  return database_error(failure);
}

Status SqliteStore::update_job(const JobRow& row) try {
  SQLite::Transaction transaction(impl_->database, SQLite::TransactionBehavior::IMMEDIATE);
  const Result<JobRow> before = job(row.id);
  if (!before.ok()) return before.error();
  if (has_ended(before->state) && !has_ended(row.state))
    if (Status status = check_job_share(impl_->database, before->token_id); !status.ok()) return status;
  SQLite::Statement change(impl_->database,
                           "UPDATE jobs SET state = ?, words = ?, attempt_count = ?, scan_id = ?, started_at_ms = ?, finished_at_ms = ? "
                           "WHERE id = ?");
  change.bind(1, std::string(name_of(row.state)));
  change.bind(2, row.message);
  change.bind(3, row.attempt_count);
  change.bind(4, row.scan_id);
  change.bind(5, row.started_at_ms);
  change.bind(6, row.finished_at_ms);
  change.bind(7, row.id);
  change.exec();
  transaction.commit();
  return Done{};
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<JobRow> SqliteStore::job(const std::string& id) try {
  SQLite::Statement query(impl_->database, std::string("SELECT ") + kJobColumns + " FROM jobs WHERE id = ?");
  query.bind(1, id);
  if (!query.executeStep()) return no_job(id);
  return job_row_of(query);
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<std::vector<JobRow>> SqliteStore::list_jobs() try {
  SQLite::Statement query(impl_->database, std::string("SELECT ") + kJobColumns + " FROM jobs ORDER BY created_at_ms DESC, id LIMIT ?");
  query.bind(1, kMaxListedJobs);
  std::vector<JobRow> rows;
  while (query.executeStep()) rows.push_back(job_row_of(query));
  return rows;
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<std::vector<JobRow>> SqliteStore::jobs_in(JobState state) try {
  SQLite::Statement query(impl_->database,
                          std::string("SELECT ") + kJobColumns + " FROM jobs WHERE state = ? ORDER BY priority DESC, created_at_ms, id");
  query.bind(1, std::string(name_of(state)));
  std::vector<JobRow> rows;
  while (query.executeStep()) rows.push_back(job_row_of(query));
  return rows;
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<std::map<JobState, int>> SqliteStore::count_jobs() try {
  std::map<JobState, int> counts;
  for (const JobState state : kAllJobStates) counts[state] = 0;
  SQLite::Statement query(impl_->database, "SELECT state, count(*) FROM jobs GROUP BY state");
  while (query.executeStep()) counts[state_of(query.getColumn(0).getString())] += query.getColumn(1).getInt();
  return counts;
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Status SqliteStore::add_job_line(const std::string& id, const JobLine& line) try {
  SQLite::Statement count(impl_->database, "SELECT count(*) FROM job_lines WHERE job_id = ?");
  count.bind(1, id);
  count.executeStep();
  const int number = count.getColumn(0).getInt();
  if (number > kMaxJobLines) return Done{};
  SQLite::Statement insert(impl_->database, "INSERT INTO job_lines(job_id, number, at_ms, words) VALUES(?,?,?,?)");
  insert.bind(1, id);
  insert.bind(2, number);
  insert.bind(3, line.at_ms);
  insert.bind(4, number == kMaxJobLines ? std::string("what follows is left out") : line.message);
  insert.exec();
  return Done{};
} catch (const SQLite::Exception& failure) {
  if (failure.getErrorCode() == SQLITE_CONSTRAINT) return no_job(id);
  return database_error(failure);
}

Result<std::vector<JobLine>> SqliteStore::job_lines(const std::string& id) try {
  SQLite::Statement query(impl_->database, "SELECT at_ms, words FROM job_lines WHERE job_id = ? ORDER BY number");
  query.bind(1, id);
  std::vector<JobLine> lines;
  while (query.executeStep()) lines.push_back({query.getColumn(0).getInt64(), query.getColumn(1).getString()});
  return lines;
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<int> SqliteStore::forget_jobs(std::int64_t ended_before_ms) try {
  SQLite::Statement change(impl_->database, "DELETE FROM jobs WHERE state NOT IN ('queued', 'running') AND finished_at_ms < ?");
  change.bind(1, ended_before_ms);
  return change.exec();
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

}  // namespace hermite
