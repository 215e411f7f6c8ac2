#include "server/store/rows_place.h"

#include <fmt/core.h>

#include <chrono>
#include <filesystem>
#include <system_error>

#include "server/database/postgres_database.h"
#include "server/database/sqlite_database.h"
#include "server/store/place_note.h"
#include "server/store/scan_id.h"

namespace hermite::server {

namespace {

namespace fs = std::filesystem;

constexpr std::chrono::milliseconds kPatience(0);  // moving all rows takes as long as it takes

constexpr const char* kUnfinishedFile = "hermite.db.unfinished";

bool has_file(const std::string& folder, const char* name) {
  std::error_code error;
  return fs::exists(folder + "/" + name, error);
}

std::optional<PlaceNote> note_of(const std::string& data_folder, const char* name) {
  return or_throw(read_place_note(data_folder + "/" + name));
}

std::string folder_id(Database& database) {
  return or_throw(read(database, [&]() -> Result<std::string> {
    return RowReader(database.run("SELECT folder_id FROM about").rows.front()).text();
  }));
}

void set_folder_id(Database& database, const std::string& id) {
  database.run("UPDATE about SET folder_id = $1", {id});
}

Error of_another_folder() {
  return {ErrorCode::kBusy,
          "the database in PostgreSQL belongs to another folder of data: create another database. "
          "If that folder is lost, restore its "
          "backup"};
}

// Checks that the database has the rows of the folder that has this id.
void check_owner(const std::string& owner, const std::string& id) {
  if (owner == id) return;
  if (!owner.empty()) throw SetupError(of_another_folder());
  throw SetupError({ErrorCode::kInvalidArgument,
                    "the database in PostgreSQL has no rows, though the file rows-at says that "
                    "those of this folder are in it: was it "
                    "created anew? Restore its backup, or that of the folder"});
}

// Joins a new folder and a new database. The note goes first, so that the database is never owned
// by an unknown folder.
void join(const std::string& data_folder, const std::string& address, Database& database) {
  const std::optional<PlaceNote> begun = note_of(data_folder, kRowsMoving);
  const std::string id = begun ? begun->id : new_scan_id(), owner = folder_id(database);
  if (!owner.empty() && owner != id) throw SetupError(of_another_folder());
  or_throw(write_place_note(data_folder + "/" + kRowsMoving, {address, id}));
  or_throw(change(database, "joining", [&]() -> Status {
    set_folder_id(database, id);
    return Done{};
  }));
  or_throw(rename_in_folder(data_folder, kRowsMoving, kRowsAt));
}

Select select_from(Database& database) {
  return [&database](const std::string& sql, const std::vector<SqlValue>& values) {
    return database.run(sql, values);
  };
}

Result<CopySummary> copy_to_postgres(const std::string& data_folder, Database& database,
                                     const std::string& id) {
  SqliteDatabase file(data_folder + "/" + kRowsFile);
  return change(database, "moving", [&]() -> Result<CopySummary> {
    Result<CopySummary> copied = copy_tables(select_from(file), database);
    if (copied.ok()) set_folder_id(database, id);
    return copied;
  });
}

// Writes all rows to a new file, which is durable afterwards.
Result<CopySummary> copy_to_file(const Select& source, const std::string& path) {
  SqliteDatabase file(path);
  return change(file, "moving", [&] { return copy_tables(source, file); });
}

void remove_unfinished(const std::string& data_folder) {
  for (const char* ending : {"", "-wal", "-shm"})
    or_throw(remove_in_folder(data_folder, std::string(kUnfinishedFile) + ending));
}

// The rows are in the file, and not needed in the database any more.
Status give_up_database(const std::string& data_folder, Database& database, const std::string& id) {
  if (folder_id(database) == id) {
    const Status emptied = change(database, "moving", [&]() -> Status {
      empty_tables(database);
      set_folder_id(database, "");
      return Done{};
    });
    if (!emptied.ok()) return emptied;
  }
  if (Status status = remove_in_folder(data_folder, kMovedRowsFile); !status.ok()) return status;
  return remove_in_folder(data_folder, kRowsMoving);
}

}  // namespace

Result<bool> are_rows_in_postgres(const std::string& data_folder) {
  const Result<std::optional<PlaceNote>> note = read_place_note(data_folder + "/" + kRowsAt);
  if (!note.ok()) return note.error();
  return note->has_value();
}

std::unique_ptr<Database> open_rows(const std::string& data_folder, const std::string& address) {
  const std::string file = data_folder + "/" + kRowsFile;
  const std::optional<PlaceNote> note = note_of(data_folder, kRowsAt);
  if (!note && address.empty()) return std::make_unique<SqliteDatabase>(file);
  if (!note && has_file(data_folder, kRowsFile))
    throw SetupError({ErrorCode::kInvalidArgument,
                      fmt::format("the rows of {} are in its file hermite.db: move them first, "
                                  "with `hermite migrate --from {} --to {}`",
                                  data_folder, data_folder, address)});
  const std::string& place = address.empty() ? note->address : address;
  auto database = std::make_unique<PostgresDatabase>(place);
  if (!note) {
    join(data_folder, place, *database);
  } else {
    check_owner(folder_id(*database), note->id);
    if (place != note->address)
      or_throw(write_place_note(data_folder + "/" + kRowsAt, {place, note->id}));
  }
  return database;
}

Result<CopySummary> move_rows_to_postgres(const std::string& data_folder,
                                          const std::string& address) {
  if (note_of(data_folder, kRowsAt))
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("the rows of {} are in PostgreSQL already, as its file rows-at says",
                             data_folder)};
  if (!has_file(data_folder, kRowsFile))
    return Error{ErrorCode::kNotFound, data_folder + " is no folder of data: it has no hermite.db"};
  const std::optional<PlaceNote> begun = note_of(data_folder, kRowsMoving);
  const std::string id = begun ? begun->id : new_scan_id();
  PostgresDatabase database(address, kPatience);
  if (const std::string owner = folder_id(database); !owner.empty() && owner != id)
    return of_another_folder();
  if (Status status = write_place_note(data_folder + "/" + kRowsMoving, {address, id});
      !status.ok())
    return status.error();
  Result<CopySummary> copied = copy_to_postgres(data_folder, database, id);
  if (!copied.ok()) return copied;
  if (Status status = rename_in_folder(data_folder, kRowsMoving, kRowsAt); !status.ok())
    return status.error();
  if (Status status = rename_in_folder(data_folder, kRowsFile, kMovedRowsFile); !status.ok())
    return status.error();
  return copied;
}

Result<CopySummary> move_rows_to_folder(const std::string& data_folder,
                                        const std::string& address) {
  const std::optional<PlaceNote> at = note_of(data_folder, kRowsAt),
                                 moving = note_of(data_folder, kRowsMoving);
  if (!at && !moving)
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("the rows of {} are not in PostgreSQL: it has no file rows-at", data_folder)};
  PostgresDatabase database(address, kPatience);
  CopySummary summary;
  if (at) {
    check_owner(folder_id(database), at->id);
    remove_unfinished(data_folder);
    const Result<CopySummary> copied =
        copy_to_file(select_from(database), data_folder + "/" + kUnfinishedFile);
    if (!copied.ok()) return copied;
    summary = *copied;
    if (Status status = rename_in_folder(data_folder, kUnfinishedFile, kRowsFile); !status.ok())
      return status.error();
    if (Status status = rename_in_folder(data_folder, kRowsAt, kRowsMoving); !status.ok())
      return status.error();
  }
  if (Status status = give_up_database(data_folder, database, at ? at->id : moving->id);
      !status.ok())
    return status.error();
  return summary;
}

Status copy_rows_to_file(const std::string& data_folder, const std::string& path) {
  const std::optional<PlaceNote> note = note_of(data_folder, kRowsAt);
  if (!note)
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("the rows of {} are not in PostgreSQL", data_folder)};
  try {
    PostgresConnection connection(note->address, {});
    connection.run_script("BEGIN ISOLATION LEVEL REPEATABLE READ READ ONLY");
    check_owner(RowReader(connection.run("SELECT folder_id FROM about").rows.front()).text(),
                note->id);
    const Result<CopySummary> copied = copy_to_file(
        [&](const std::string& sql, const std::vector<SqlValue>& values) {
          return connection.run(sql, values);
        },
        path);
    return copied.ok() ? Status(Done{}) : Status(copied.error());
  } catch (const DatabaseFailure& failure) {
    return error_of(failure, "the database in PostgreSQL");
  }
}

}  // namespace hermite::server
