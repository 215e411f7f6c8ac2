#include "server/database/postgres_schema.h"

#include <fmt/core.h>

#include <array>
#include <string_view>

#include "core/base/result.h"

namespace hermite::server {

namespace {

// Step N changes `about.version` from N to N + 1. Never edit one that was released: add another,
// here and in sqlite_schema.cpp. The tables are those of SQLite, with the reasons given there.
// Texts are compared byte by byte, as there; folder_id says which folder of data belongs to these
// rows (server/store/rows_place.h).
constexpr std::array<std::string_view, 2> kSteps = {
    R"sql(
CREATE SCHEMA hermite;
SET LOCAL search_path = hermite;
CREATE DOMAIN plain_text AS TEXT COLLATE "C";
CREATE TABLE about(
  only_row BIGINT PRIMARY KEY CHECK (only_row = 1),
  version BIGINT NOT NULL,
  folder_id plain_text NOT NULL
);
INSERT INTO about VALUES(1, 0, '');
CREATE TABLE scans(
  id plain_text PRIMARY KEY,
  title plain_text NOT NULL,
  phase plain_text NOT NULL CHECK (phase IN ('running', 'finished', 'failed', 'interrupted')),
  words plain_text NOT NULL,
  width BIGINT NOT NULL, height BIGINT NOT NULL,
  fx DOUBLE PRECISION NOT NULL, fy DOUBLE PRECISION NOT NULL,)sql"
    R"sql( cx DOUBLE PRECISION NOT NULL, cy DOUBLE PRECISION NOT NULL,
  depth_units_per_metre DOUBLE PRECISION NOT NULL,
  frames_received BIGINT NOT NULL,
  frames_processed BIGINT NOT NULL,
  frames_dropped BIGINT NOT NULL,
  created_at_ms BIGINT NOT NULL,
  finished_at_ms BIGINT NOT NULL,
  token_id plain_text NOT NULL,
  to_be_rebuilt BIGINT NOT NULL CHECK (to_be_rebuilt IN (0, 1))
);
CREATE INDEX scans_by_time ON scans(created_at_ms DESC, id);
CREATE INDEX scans_to_rebuild ON scans(created_at_ms, id) WHERE to_be_rebuilt = 1;
CREATE INDEX scans_by_token ON scans(token_id);
CREATE TABLE tokens(
  id plain_text PRIMARY KEY,
  secret_sha256 BYTEA NOT NULL UNIQUE CHECK (octet_length(secret_sha256) = 32),
  name plain_text NOT NULL,
  may_view BIGINT NOT NULL CHECK (may_view IN (0, 1)),
  may_scan BIGINT NOT NULL CHECK (may_scan IN (0, 1)),
  may_admin BIGINT NOT NULL CHECK (may_admin IN (0, 1)),
  scan_id plain_text REFERENCES scans(id) ON DELETE CASCADE,
  created_at_ms BIGINT NOT NULL,
  expires_at_ms BIGINT NOT NULL,
  used_at_ms BIGINT NOT NULL,
  revoked_at_ms BIGINT NOT NULL,
  made_by plain_text NOT NULL,
  CHECK (scan_id IS NULL OR (may_view = 1 AND may_scan = 0 AND may_admin = 0))
);
CREATE INDEX tokens_by_scan ON tokens(scan_id);
CREATE INDEX tokens_by_maker ON tokens(made_by);
CREATE TABLE uploads(
  id plain_text PRIMARY KEY,
  token_id plain_text NOT NULL,
  length_bytes BIGINT NOT NULL,
  metadata plain_text NOT NULL,
  unchecked_from BIGINT NOT NULL,
  created_at_ms BIGINT NOT NULL,
  expires_at_ms BIGINT NOT NULL
);
CREATE TABLE jobs(
  id plain_text PRIMARY KEY,
  token_id plain_text NOT NULL,
  title plain_text NOT NULL,
  source plain_text NOT NULL CHECK (source IN ('upload', 'scan')),
  source_id plain_text NOT NULL,
  settings plain_text NOT NULL,
  camera plain_text NOT NULL,
  priority BIGINT NOT NULL,
  state plain_text NOT NULL)sql"
    R"sql( CHECK (state IN ('queued', 'running', 'finished', 'failed', 'cancelled')),
  words plain_text NOT NULL,
  attempt_count BIGINT NOT NULL,
  scan_id plain_text NOT NULL,
  created_at_ms BIGINT NOT NULL,
  started_at_ms BIGINT NOT NULL,
  finished_at_ms BIGINT NOT NULL
);
CREATE INDEX jobs_by_turn ON jobs(state, priority DESC, created_at_ms, id);
CREATE TABLE job_lines(
  job_id plain_text NOT NULL REFERENCES jobs(id) ON DELETE CASCADE,
  number BIGINT NOT NULL,
  at_ms BIGINT NOT NULL,
  words plain_text NOT NULL,
  PRIMARY KEY (job_id, number)
);
CREATE TABLE measurements(
  id plain_text PRIMARY KEY,
  scan_id plain_text NOT NULL REFERENCES scans(id) ON DELETE CASCADE,
  name plain_text NOT NULL,
  value DOUBLE PRECISION NOT NULL,
  half_width DOUBLE PRECISION NOT NULL,
  created_at_ms BIGINT NOT NULL,
  kind plain_text NOT NULL CHECK (kind IN ('distance', 'plane', 'height', 'angle', 'area')),
  up_x DOUBLE PRECISION, up_y DOUBLE PRECISION, up_z DOUBLE PRECISION
);
CREATE INDEX measurements_by_scan ON measurements(scan_id, created_at_ms, id);
CREATE TABLE measurement_points(
  measurement_id plain_text NOT NULL REFERENCES measurements(id) ON DELETE CASCADE,
  number BIGINT NOT NULL,
  x DOUBLE PRECISION NOT NULL, y DOUBLE PRECISION NOT NULL, z DOUBLE PRECISION NOT NULL,
  normal_x DOUBLE PRECISION, normal_y DOUBLE PRECISION, normal_z DOUBLE PRECISION,
  PRIMARY KEY (measurement_id, number)
);
CREATE TABLE notes(
  id plain_text PRIMARY KEY,
  scan_id plain_text NOT NULL REFERENCES scans(id) ON DELETE CASCADE,
  x DOUBLE PRECISION NOT NULL, y DOUBLE PRECISION NOT NULL, z DOUBLE PRECISION NOT NULL,
  eye_x DOUBLE PRECISION, eye_y DOUBLE PRECISION, eye_z DOUBLE PRECISION,
  target_x DOUBLE PRECISION, target_y DOUBLE PRECISION, target_z DOUBLE PRECISION,
  text plain_text NOT NULL,
  version BIGINT NOT NULL,
  created_at_ms BIGINT NOT NULL,
  changed_at_ms BIGINT NOT NULL,
  CHECK (num_nulls(eye_x, eye_y, eye_z, target_x, target_y, target_z) IN (0, 6))
);
CREATE INDEX notes_by_scan ON notes(scan_id, created_at_ms, id);
)sql",
    R"sql(
ALTER TABLE scans ADD COLUMN tags plain_text NOT NULL DEFAULT '';
)sql"};

// 0: there is no schema yet.
std::int64_t version_of(PostgresConnection& connection) {
  if (connection.run("SELECT 1 FROM pg_namespace WHERE nspname = 'hermite'").rows.empty()) return 0;
  if (connection.run("SELECT 1 FROM pg_tables WHERE schemaname = 'hermite' AND tablename = 'about'")
          .rows.empty())
    throw SetupError(
        {ErrorCode::kUnsupported, "the schema hermite of the database belongs to another program"});
  const SqlResult about = connection.run("SELECT version FROM about");
  return about.rows.empty() ? 0 : RowReader(about.rows.front()).integer();
}

}  // namespace

void migrate(PostgresConnection& connection) {
  const std::int64_t version = version_of(connection), last = kSteps.size();
  if (version > last)
    throw SetupError(
        {ErrorCode::kUnsupported, fmt::format("the database has schema {}, this program knows up "
                                              "to {}: run the newer hermite that wrote it",
                                              version, last)});
  for (std::int64_t step = version; step < last; ++step)
    connection.run_script(fmt::format("BEGIN;{}UPDATE about SET version = {}; COMMIT",
                                      kSteps[static_cast<std::size_t>(step)], step + 1));
}

}  // namespace hermite::server
