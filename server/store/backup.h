// A copy of a data folder, taken while its server runs or not, and put back.
//
// The database is copied by SQLite in one transaction that only reads, so that the copy is of one moment; this connection never writes a
// checkpoint (see sqlite_store.h). Then come the token and the files of every scan. What a scan that runs has written so far is copied as
// it is: after a restore it is an interrupted scan.
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"

namespace hermite {

struct BackupSummary {
  std::int64_t scan_count = 0;  // rows of the database
  std::int64_t file_count = 0;  // besides the database
  std::uint64_t bytes = 0;
};

// `backup` must not be there yet; it is there whole, under its name, or not at all. kNotFound: no database in `data`. kInvalidArgument:
// `backup` exists. kIo, naming the file; kCorruptData: the copy of the database does not pass SQLite's check.
Result<BackupSummary> back_up(const std::string& data, const std::string& backup);

// Checks the backup's database, then copies everything into `data`, which must be empty or not there: nothing is ever overwritten. Errors
// as above. While it works the folder has a mark (kRestoreMark) that no server starts with; where one is left by a restore that was cut
// off, what came of that is removed first.
Result<BackupSummary> restore(const std::string& backup, const std::string& data);

}  // namespace hermite
