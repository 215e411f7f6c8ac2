#include "server/store/store.h"

#include <utility>

#include "server/database/sqlite_database.h"

namespace hermite::server {

Store::Store(std::unique_ptr<Database> database) : database_(std::move(database)) {}
Store::Store(const std::string& sqlite_path)
    : Store(std::make_unique<SqliteDatabase>(sqlite_path)) {}

}  // namespace hermite::server
