#include "server/database/sqlite_schema.h"

#include <SQLiteCpp/Backup.h>
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/core.h>
#include <sqlite3.h>

#include <array>
#include <filesystem>
#include <string_view>

#include "core/base/result.h"

namespace hermite::server {

namespace {

constexpr int kApplicationId = 0x48524246;  // "HRBF"

// Migration N changes user_version from N to N + 1. Never edit one that was released: add another.
constexpr std::array<std::string_view, 8> kMigrations = {
    R"sql(
CREATE TABLE scans(
  id TEXT PRIMARY KEY NOT NULL,
  title TEXT NOT NULL,
  phase TEXT NOT NULL CHECK (phase IN ('running', 'finished', 'failed', 'interrupted')),
  words TEXT NOT NULL,
  width INTEGER NOT NULL, height INTEGER NOT NULL,
  fx REAL NOT NULL, fy REAL NOT NULL, cx REAL NOT NULL, cy REAL NOT NULL,
  depth_units_per_metre REAL NOT NULL,
  frames_received INTEGER NOT NULL,
  frames_processed INTEGER NOT NULL,
  frames_dropped INTEGER NOT NULL,
  created_at_ms INTEGER NOT NULL,
  finished_at_ms INTEGER NOT NULL
) STRICT;
CREATE INDEX scans_by_time ON scans(created_at_ms DESC, id);
)sql",
    // A share link is a token that grants access to one scan. With a single table, one code path
    // checks, expires and revokes both.
    R"sql(
CREATE TABLE tokens(
  id TEXT PRIMARY KEY NOT NULL,
  secret_sha256 BLOB NOT NULL UNIQUE CHECK (length(secret_sha256) = 32),
  name TEXT NOT NULL,
  may_view INTEGER NOT NULL CHECK (may_view IN (0, 1)),
  may_scan INTEGER NOT NULL CHECK (may_scan IN (0, 1)),
  may_admin INTEGER NOT NULL CHECK (may_admin IN (0, 1)),
  scan_id TEXT REFERENCES scans(id) ON DELETE CASCADE,
  created_at_ms INTEGER NOT NULL,
  expires_at_ms INTEGER NOT NULL,
  used_at_ms INTEGER NOT NULL,
  revoked_at_ms INTEGER NOT NULL,
  CHECK (scan_id IS NULL OR (may_view = 1 AND may_scan = 0 AND may_admin = 0))
) STRICT;
CREATE INDEX tokens_by_scan ON tokens(scan_id);
)sql",
    // No foreign keys: a job outlives its source and the token that requested it.
    R"sql(
CREATE TABLE uploads(
  id TEXT PRIMARY KEY NOT NULL,
  token_id TEXT NOT NULL,
  length_bytes INTEGER NOT NULL,
  metadata TEXT NOT NULL,
  unchecked_from INTEGER NOT NULL,
  created_at_ms INTEGER NOT NULL,
  expires_at_ms INTEGER NOT NULL
) STRICT;
CREATE TABLE jobs(
  id TEXT PRIMARY KEY NOT NULL,
  token_id TEXT NOT NULL,
  title TEXT NOT NULL,
  source TEXT NOT NULL CHECK (source IN ('upload', 'scan')),
  source_id TEXT NOT NULL,
  settings TEXT NOT NULL,
  camera TEXT NOT NULL,
  priority INTEGER NOT NULL,
  state TEXT NOT NULL CHECK (state IN ('queued', 'running', 'finished', 'failed', 'cancelled')),
  words TEXT NOT NULL,
  attempt_count INTEGER NOT NULL,
  scan_id TEXT NOT NULL,
  created_at_ms INTEGER NOT NULL,
  started_at_ms INTEGER NOT NULL,
  finished_at_ms INTEGER NOT NULL
) STRICT;
CREATE INDEX jobs_by_turn ON jobs(state, priority DESC, created_at_ms, id);
CREATE TABLE job_lines(
  job_id TEXT NOT NULL REFERENCES jobs(id) ON DELETE CASCADE,
  number INTEGER NOT NULL,
  at_ms INTEGER NOT NULL,
  words TEXT NOT NULL,
  PRIMARY KEY (job_id, number)
) STRICT;
)sql",
    // Owners, so that each token has its share; and scans whose results did not fit on a full disk.
    R"sql(
ALTER TABLE scans ADD COLUMN token_id TEXT NOT NULL DEFAULT '';
ALTER TABLE scans ADD COLUMN to_be_rebuilt INTEGER NOT NULL DEFAULT 0)sql"
    R"sql( CHECK (to_be_rebuilt IN (0, 1));
ALTER TABLE tokens ADD COLUMN made_by TEXT NOT NULL DEFAULT '';
CREATE INDEX scans_to_rebuild ON scans(created_at_ms, id) WHERE to_be_rebuilt = 1;
CREATE INDEX scans_by_token ON scans(token_id);
CREATE INDEX tokens_by_maker ON tokens(made_by);
)sql",
    R"sql(
CREATE TABLE measurements(
  id TEXT PRIMARY KEY NOT NULL,
  scan_id TEXT NOT NULL REFERENCES scans(id) ON DELETE CASCADE,
  name TEXT NOT NULL,
  from_x REAL NOT NULL, from_y REAL NOT NULL, from_z REAL NOT NULL,
  to_x REAL NOT NULL, to_y REAL NOT NULL, to_z REAL NOT NULL,
  distance_m REAL NOT NULL,
  half_width_m REAL NOT NULL,
  created_at_ms INTEGER NOT NULL
) STRICT;
CREATE INDEX measurements_by_scan ON measurements(scan_id, created_at_ms, id);
)sql",
    // Other kinds than distances, with as many points as they need. Existing measurements have no
    // normals.
    R"sql(
ALTER TABLE measurements ADD COLUMN kind TEXT NOT NULL DEFAULT 'distance')sql"
    R"sql( CHECK (kind IN ('distance', 'plane', 'height', 'angle', 'area'));
ALTER TABLE measurements ADD COLUMN up_x REAL;
ALTER TABLE measurements ADD COLUMN up_y REAL;
ALTER TABLE measurements ADD COLUMN up_z REAL;
ALTER TABLE measurements RENAME COLUMN distance_m TO value;
ALTER TABLE measurements RENAME COLUMN half_width_m TO half_width;
CREATE TABLE measurement_points(
  measurement_id TEXT NOT NULL REFERENCES measurements(id) ON DELETE CASCADE,
  number INTEGER NOT NULL,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  normal_x REAL, normal_y REAL, normal_z REAL,
  PRIMARY KEY (measurement_id, number)
) STRICT;
INSERT INTO measurement_points(measurement_id, number, x, y, z)
  SELECT id, 0, from_x, from_y, from_z FROM measurements)sql"
    R"sql( UNION ALL SELECT id, 1, to_x, to_y, to_z FROM measurements;
ALTER TABLE measurements DROP COLUMN from_x;
ALTER TABLE measurements DROP COLUMN from_y;
ALTER TABLE measurements DROP COLUMN from_z;
ALTER TABLE measurements DROP COLUMN to_x;
ALTER TABLE measurements DROP COLUMN to_y;
ALTER TABLE measurements DROP COLUMN to_z;
)sql",
    // The view is there as a whole or not at all.
    R"sql(
CREATE TABLE notes(
  id TEXT PRIMARY KEY NOT NULL,
  scan_id TEXT NOT NULL REFERENCES scans(id) ON DELETE CASCADE,
  x REAL NOT NULL, y REAL NOT NULL, z REAL NOT NULL,
  eye_x REAL, eye_y REAL, eye_z REAL,
  target_x REAL, target_y REAL, target_z REAL,
  text TEXT NOT NULL,
  version INTEGER NOT NULL,
  created_at_ms INTEGER NOT NULL,
  changed_at_ms INTEGER NOT NULL,
  CHECK ((eye_x IS NULL) + (eye_y IS NULL) + (eye_z IS NULL))sql"
    R"sql( + (target_x IS NULL) + (target_y IS NULL) + (target_z IS NULL) IN (0, 6))
) STRICT;
CREATE INDEX notes_by_scan ON notes(scan_id, created_at_ms, id);
)sql",
    // One tag a line, as they are only ever read and written together.
    R"sql(
ALTER TABLE scans ADD COLUMN tags TEXT NOT NULL DEFAULT '';
)sql"};

int pragma(SQLite::Database& database, const std::string& name) {
  return database.execAndGet("PRAGMA " + name).getInt();
}

// Written under another name first, so that a file with the backup's name is always complete.
void back_up(SQLite::Database& database, const std::string& path, int version) {
  const std::string backup = backup_path(path, version), partial = backup + ".partial";
  const auto failed = [&backup](const std::string& why) {
    return SetupError(
        {ErrorCode::kIo,
         fmt::format(
             "the database is older than this program and is copied to {} before it is changed: {}",
             backup, why)});
  };
  std::error_code error;
  std::filesystem::remove(partial, error);
  if (error) throw failed(error.message());
  try {
    SQLite::Database target(partial, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
    SQLite::Backup copy(target, database);
    if (copy.executeStep(-1) != SQLITE_DONE) throw failed("another program is using it");
  } catch (const SQLite::Exception& failure) {
    throw failed(failure.what());
  }
  std::filesystem::rename(partial, backup, error);
  if (error) throw failed(error.message());
}

}  // namespace

int schema_version() { return static_cast<int>(kMigrations.size()); }

std::string backup_path(const std::string& path, int version) {
  return fmt::format("{}.schema-{}", path, version);
}

void migrate(SQLite::Database& database, const std::string& path) {
  const int version = pragma(database, "user_version"),
            application = pragma(database, "application_id");
  const bool empty = database.execAndGet("SELECT count(*) FROM sqlite_schema").getInt() == 0;
  if (!(empty && application == 0) && application != kApplicationId)
    throw SetupError({ErrorCode::kUnsupported, path + " is a database of another program"});
  if (version > schema_version())
    throw SetupError(
        {ErrorCode::kUnsupported,
         fmt::format(
             "{} has schema {}, this program knows up to {}: run the newer hermite that wrote it",
             path, version, schema_version())});
  if (!empty && version < schema_version()) back_up(database, path, version);
  for (int step = version; step < schema_version(); ++step) {
    SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
    database.exec(std::string(kMigrations[static_cast<std::size_t>(step)]));
    database.exec(fmt::format("PRAGMA application_id = {}", kApplicationId));
    database.exec(fmt::format("PRAGMA user_version = {}", step + 1));
    transaction.commit();
  }
}

}  // namespace hermite::server
