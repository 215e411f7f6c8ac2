// Where the rows of a folder of data are: in its file hermite.db, or in PostgreSQL. Folder and
// database know of each other, so that neither two folders share a database, nor a server starts
// without the rows of its folder:
//   DATA/rows-at      the address of the database, and the id of the folder, which is made with it
//   about.folder_id   that id, in the database
//
// While rows move in either direction, the note is in DATA/rows-moving: until all are in
// PostgreSQL, and from when all are in the file. So hermite.db is where a server looks for them.
#pragma once

#include <memory>
#include <string>

#include "core/base/result.h"
#include "server/database/copy_tables.h"
#include "server/database/database.h"

namespace hermite::server {

// Names in a folder of data.
inline constexpr const char *kRowsFile = "hermite.db", *kRowsAt = "rows-at",
                            *kRowsMoving = "rows-moving";
// The file as it was before its rows were moved.
inline constexpr const char* kMovedRowsFile = "hermite.db.moved";

// Returns whether the rows are in PostgreSQL. kIo, kCorruptData.
Result<bool> are_rows_in_postgres(const std::string& data_folder);

// Opens the database of a folder, which this process has locked. `address` is that of PostgreSQL;
// empty: where the folder says, or in its file. A new folder is joined to a new database. Throws
// SetupError, with a message: see SqliteDatabase and PostgresDatabase; kInvalidArgument: the rows
// are somewhere else; kBusy: the database belongs to another folder.
std::unique_ptr<Database> open_rows(const std::string& data_folder, const std::string& address);

// Move the rows of a folder that no server uses. They are copied in one transaction and compared by
// their SHA-256. What was interrupted is started again. kInvalidArgument: they are not where they
// should be. kBusy: the database belongs to another folder. kCorruptData: other rows came back than
// were copied. kIo. Throw SetupError like open_rows().
Result<CopySummary> move_rows_to_postgres(const std::string& data_folder,
                                          const std::string& address);
Result<CopySummary> move_rows_to_folder(const std::string& data_folder, const std::string& address);

// Writes the rows in PostgreSQL, as they are at one moment, to a new SQLite file, while a server
// uses them or not. kIo, kCorruptData, kInvalidArgument. Throws SetupError.
Status copy_rows_to_file(const std::string& data_folder, const std::string& path);

}  // namespace hermite::server
