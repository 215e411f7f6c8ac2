// The schema of the database, and its migration from older versions. For the sources of
// SqliteDatabase only.
#pragma once

#include <string>

namespace SQLite {
class Database;
}

namespace hermite::server {

// Returns the version of the schema that this program writes (SQLite's user_version).
int schema_version();

// Migrates `database`, which is the file at `path`, to schema_version(), with one transaction per
// step. Before the first step, a database that is not empty is copied to backup_path(). Throws
// SetupError: the database belongs to another program or is newer than this program (it is left
// unchanged in both cases), or the backup cannot be written. Throws SQLite::Exception otherwise.
void migrate(SQLite::Database& database, const std::string& path);

// Returns "PATH.schema-1" for version 1: the copy of the database as it was before its migration
// from that version.
std::string backup_path(const std::string& path, int version);

}  // namespace hermite::server
