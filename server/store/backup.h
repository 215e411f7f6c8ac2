// Backs up a data folder, while its server runs or not, and restores it.
//
// The database is copied in one transaction that only reads, so that the copy is consistent; a
// connection to a SQLite file never runs a WAL checkpoint meanwhile (see sqlite_database.h). Rows
// in PostgreSQL are in the backup as a SQLite file, and after a restore in that of the folder. Then
// the token and the files of every scan are copied. What a running scan has written so far is
// copied as it is; after a restore it is an interrupted scan.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite::server {

struct BackupSummary {
  std::int64_t scan_count = 0;  // rows in the database
  std::int64_t file_count = 0;  // without the database
  std::uint64_t bytes = 0;
};

// Creates `backup`, which must not exist yet; it is created whole or not at all. kNotFound: no
// database in `data`. kInvalidArgument: `backup` exists. kIo, naming the file. kCorruptData: the
// copy of the database does not pass SQLite's check.
Result<BackupSummary> back_up(const std::string& data, const std::string& backup);

// Checks the database of the backup, then copies everything into `data`, which must be empty or not
// exist: nothing is ever overwritten. Errors as above. Meanwhile the folder has a mark
// (kRestoreMark) with which no server starts. The remains of an earlier restore that was
// interrupted are removed first.
Result<BackupSummary> restore(const std::string& backup, const std::string& data);

}  // namespace hermite::server
