// The schema of the database in PostgreSQL, and its migration from older versions. For the sources
// of server/database only.
#pragma once

#include <string>

#include "server/database/postgres_connection.h"

namespace hermite::server {

// Creates the schema `hermite` or migrates it to the present version, with one transaction per
// step. Throws SetupError: it belongs to another program or is newer than this program (left
// unchanged in both cases). Throws DatabaseFailure otherwise.
void migrate(PostgresConnection& connection);

}  // namespace hermite::server
