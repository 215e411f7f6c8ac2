// The connection behind SqliteStore, for its sources only.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <string>

#include "server/store/sqlite_store.h"

namespace hermite {

struct SqliteStore::Impl {
  SQLite::Database database;

  // Opens or creates the file without changing anything yet. Throws SQLite::Exception.
  explicit Impl(const std::string& path);
};

// Returns kIo with SQLite's message.
Error database_error(const SQLite::Exception& failure);

// Returns whether a token has the scope admin. An empty id, which is the owner of the data folder, does; an unknown
// token does not. Throws.
bool may_administer(SQLite::Database& database, const std::string& token_id);

// Runs `count`, a statement that returns a total and how many of it belong to the token, which is its parameter 1.
// Throws.
Taken taken_of(SQLite::Statement& count, const std::string& token_id);

}  // namespace hermite
