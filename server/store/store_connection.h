// The one connection behind Store, for the sources of Store only.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <string>

#include "server/store/store.h"

namespace hermite {

struct Store::Impl {
  SQLite::Database database;

  // Opens or creates; changes nothing yet. Throws SQLite::Exception.
  explicit Impl(const std::string& path);
};

// kIo, with SQLite's words.
Error database_error(const SQLite::Exception& failure);

}  // namespace hermite
