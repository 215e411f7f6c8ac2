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

}  // namespace hermite
