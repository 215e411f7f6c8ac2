#include "server/store/job_table.h"

#include "server/store/table_tools.h"

namespace hermite::server {

namespace {

constexpr const char* kJobColumns =
    "id, token_id, title, source, source_id, settings, camera, priority, state, words, "
    "attempt_count, scan_id, created_at_ms, "
    "started_at_ms, finished_at_ms";
const std::string kSelectJobs = std::string("SELECT ") + kJobColumns + " FROM jobs ";

JobState state_of(const std::string& name) {
  for (const JobState state : kAllJobStates)
    if (name == name_of(state)) return state;
  return JobState::kFailed;
}

std::vector<SqlValue> values_of(const JobRow& row) {
  return {row.id,
          row.token_id,
          row.title,
          name_of(row.source),
          row.source_id,
          row.settings,
          row.camera,
          row.priority,
          name_of(row.state),
          row.message,
          row.attempt_count,
          row.scan_id,
          row.created_at_ms,
          row.started_at_ms,
          row.finished_at_ms};
}

JobRow job_row_of(const SqlRow& values) {
  RowReader next(values);
  JobRow row;
  row.id = next.text();
  row.token_id = next.text();
  row.title = next.text();
  row.source = next.text() == name_of(JobSource::kScan) ? JobSource::kScan : JobSource::kUpload;
  row.source_id = next.text();
  row.settings = next.text();
  row.camera = next.text();
  row.priority = next.small_integer();
  row.state = state_of(next.text());
  row.message = next.text();
  row.attempt_count = next.small_integer();
  row.scan_id = next.text();
  row.created_at_ms = next.integer();
  row.started_at_ms = next.integer();
  row.finished_at_ms = next.integer();
  return row;
}

Error no_job(const std::string& id) { return {ErrorCode::kNotFound, "there is no job " + id}; }

Result<JobRow> find_job(Database& database, const std::string& id) {
  const SqlResult result = database.run(kSelectJobs + "WHERE id = $1", {id});
  if (result.rows.empty()) return no_job(id);
  return job_row_of(result.rows.front());
}

// Checks whether a token may have one more job that is queued or running.
Status check_job_share(Database& database, const std::string& token_id) {
  const Taken taken = taken_of(database,
                               "SELECT count(*), count(*) FILTER (WHERE token_id = $1) FROM jobs "
                               "WHERE state IN ('queued', 'running')",
                               {token_id});
  return check_share(kJobShare, taken, may_administer(database, token_id), "jobs that wait or run");
}

// Keeps only the newest kMaxEndedJobsPerToken ended jobs of a token.
void forget_surplus_jobs(Database& database, const std::string& token_id) {
  database.run(std::string("DELETE FROM jobs WHERE id IN (SELECT id FROM jobs WHERE token_id = $1 "
                           "AND state NOT IN ('queued', 'running') "
                           "ORDER BY finished_at_ms DESC, id LIMIT ") +
                   kNoLimit + " OFFSET $2)",
               {token_id, kMaxEndedJobsPerToken});
}

}  // namespace

Status JobTable::add(const JobRow& row) {
  return change(database_, "job " + row.id, [&]() -> Status {
    if (!has_ended(row.state))
      if (Status status = check_job_share(database_, row.token_id); !status.ok()) return status;
    database_.run(insertion("jobs", kJobColumns), values_of(row));
    forget_surplus_jobs(database_, row.token_id);
    return Done{};
  });
}

Status JobTable::update(const JobRow& row) {
  return change(database_, "job " + row.id, [&]() -> Status {
    const Result<JobRow> before = find_job(database_, row.id);
    if (!before.ok()) return before.error();
    if (has_ended(before->state) && !has_ended(row.state))
      if (Status status = check_job_share(database_, before->token_id); !status.ok()) return status;
    database_.run(
        "UPDATE jobs SET state = $1, words = $2, attempt_count = $3, scan_id = $4, started_at_ms = "
        "$5, finished_at_ms = $6 WHERE id = $7",
        {name_of(row.state), row.message, row.attempt_count, row.scan_id, row.started_at_ms,
         row.finished_at_ms, row.id});
    return Done{};
  });
}

Result<JobRow> JobTable::find(const std::string& id) {
  return read(database_, [&] { return find_job(database_, id); });
}

Result<std::vector<JobRow>> JobTable::list() {
  return read(database_, [&] {
    return rows_of(
        database_.run(kSelectJobs + "ORDER BY created_at_ms DESC, id LIMIT $1", {kMaxListedJobs}),
        job_row_of);
  });
}

Result<std::vector<JobRow>> JobTable::in_state(JobState state) {
  return read(database_, [&] {
    return rows_of(
        database_.run(kSelectJobs + "WHERE state = $1 ORDER BY priority DESC, created_at_ms, id",
                      {name_of(state)}),
        job_row_of);
  });
}

Result<std::map<JobState, int>> JobTable::count() {
  return read(database_, [&]() -> Result<std::map<JobState, int>> {
    std::map<JobState, int> counts;
    for (const JobState state : kAllJobStates) counts[state] = 0;
    for (const SqlRow& row :
         database_.run("SELECT state, count(*) FROM jobs GROUP BY state").rows) {
      RowReader next(row);
      const JobState state = state_of(next.text());
      counts[state] += next.small_integer();
    }
    return counts;
  });
}

Status JobTable::add_line(const std::string& id, const JobLine& line) {
  return change(database_, "job " + id, [&]() -> Status {
    const SqlResult count = database_.run(
        "SELECT (SELECT count(*) FROM job_lines WHERE job_id = $1) FROM jobs WHERE id = $1", {id});
    if (count.rows.empty()) return no_job(id);
    const std::int64_t number = RowReader(count.rows.front()).integer();
    if (number > kMaxJobLines) return Done{};
    database_.run(
        insertion("job_lines", "job_id, number, at_ms, words"),
        {id, number, line.at_ms,
         number == kMaxJobLines ? std::string("what follows is left out") : line.message});
    return Done{};
  });
}

Result<std::vector<JobLine>> JobTable::lines_of(const std::string& id) {
  return read(database_, [&]() -> Result<std::vector<JobLine>> {
    std::vector<JobLine> lines;
    for (const SqlRow& row :
         database_.run("SELECT at_ms, words FROM job_lines WHERE job_id = $1 ORDER BY number", {id})
             .rows) {
      RowReader next(row);
      const std::int64_t at_ms = next.integer();
      lines.push_back({at_ms, next.text()});
    }
    return lines;
  });
}

Result<int> JobTable::forget(std::int64_t ended_before_ms) {
  return change(database_, "jobs", [&]() -> Result<int> {
    return database_
        .run("DELETE FROM jobs WHERE state NOT IN ('queued', 'running') AND finished_at_ms < $1",
             {ended_before_ms})
        .changed_count;
  });
}

}  // namespace hermite::server
