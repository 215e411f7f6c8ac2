// The one connection behind SqliteStore, for its sources only.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <string>

#include "server/store/sqlite_store.h"

namespace hermite {

struct SqliteStore::Impl {
  SQLite::Database database;

  // Opens or creates; changes nothing yet. Throws SQLite::Exception.
  explicit Impl(const std::string& path);
};

// kIo, with SQLite's words.
Error database_error(const SQLite::Exception& failure);

// Whether a token may administer, or is nobody's (the owner of the data folder). A token that is not there may not. Throws.
bool may_administer(SQLite::Database& database, const std::string& token_id);

// What `count` finds for that token: a statement that gives how many there are, and how many of them are the token's, its parameter 1.
// Throws.
Taken taken_of(SQLite::Statement& count, const std::string& token_id);

}  // namespace hermite
