// The schema of the database and how an older one becomes today's. For the sources of SqliteStore only.
#pragma once

#include <string>

namespace SQLite {
class Database;
}

namespace hermite {

// The schema that this program writes (SQLite's user_version).
int schema_version();

// Brings `database`, which is the file at `path`, to schema_version(): one transaction a step. Before the first step a database that holds
// anything is copied to backup_path(). Throws SetupError: of another program, newer than this program (both are left as they are), or the
// backup cannot be written. SQLite::Exception otherwise.
void migrate(SQLite::Database& database, const std::string& path);

// "PATH.schema-1": the database as it was before it left schema 1.
std::string backup_path(const std::string& path, int version);

}  // namespace hermite
