#include "server/store/backup.h"

#include <SQLiteCpp/Backup.h>
#include <SQLiteCpp/SQLiteCpp.h>
#include <fmt/core.h>
#include <sqlite3.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <set>
#include <system_error>

#include "core/base/sync_path.h"
#include "server/database/sqlite_reader.h"
#include "server/store/data_directory.h"
#include "server/store/rows_place.h"

namespace hermite::server {

namespace {

namespace fs = std::filesystem;

constexpr const char* kUnfinished = ".partial";

Error io_error(const std::string& what, const std::error_code& error) {
  return {ErrorCode::kIo, what + ": " + error.message()};
}

Result<std::int64_t> check_database(const std::string& path) try {
  if (Status status = check_sqlite_file(path); !status.ok()) return status.error();
  SqliteReader reader(path);
  return reader.database().execAndGet("SELECT count(*) FROM scans").getInt64();
} catch (const SQLite::Exception& failure) {
  return Error{ErrorCode::kCorruptData, path + ": " + failure.what()};
}

Status copy_file_of_rows(const std::string& from, const std::string& to) try {
  SqliteReader reader(from);
  SQLite::Database copy(to, SQLite::OPEN_READWRITE | SQLite::OPEN_CREATE);
  SQLite::Backup backup(copy, reader.database());
  if (backup.executeStep(-1) != SQLITE_DONE)
    return Error{ErrorCode::kIo, fmt::format("copying the database {}: it is locked", from)};
  return Done{};
} catch (const SQLite::Exception& failure) {
  return Error{ErrorCode::kIo, fmt::format("copying the database {}: {}", from, failure.what())};
}

// From a folder to a file.
Status copy_database(const std::string& from, const std::string& to) try {
  const Result<bool> elsewhere = are_rows_in_postgres(from);
  if (!elsewhere.ok()) return elsewhere.error();
  return *elsewhere ? copy_rows_to_file(from, to) : copy_file_of_rows(from + "/" + kRowsFile, to);
} catch (const SetupError& failure) {
  return failure.error();
}

// Leaves out the files of a running server, those that its jobs have unpacked, removed and lost
// files, and the database, which was copied before, and is in the backup itself wherever it was.
bool is_left_out(const fs::path& relative) {
  static const std::set<std::string> names{"lock",           "hermite.db",   "hermite.db-wal",
                                           "hermite.db-shm", kMovedRowsFile, kRowsAt,
                                           kRowsMoving,      kRestoreMark};
  static const std::set<std::string> folders{"jobs", "waste", "lost"};
  if (relative == fs::path(kAuditFolder) / kAuditHeadName) return true;  // copied before the rest
  return names.contains(relative.string()) || folders.contains(relative.begin()->string());
}

Status copy_file(const fs::path& from, const fs::path& to, BackupSummary& summary) {
  std::error_code error;
  fs::copy_file(from, to, error);
  // It was removed after it had been listed, and its scan with it.
  if (error == std::errc::no_such_file_or_directory && !fs::exists(from)) return Done{};
  if (error) return io_error("copying " + from.string(), error);
  fs::permissions(to, fs::perms::owner_read | fs::perms::owner_write, error);
  if (error) return io_error(fmt::format("making {} private", to.string()), error);
  if (Status status = sync_path(to); !status.ok()) return status;
  ++summary.file_count;
  summary.bytes += fs::file_size(to, error);
  return Done{};
}

Status copy_audit_head(const fs::path& from, const fs::path& to, BackupSummary& summary) {
  const fs::path head = from / kAuditFolder / kAuditHeadName;
  std::error_code error;
  if (!fs::is_regular_file(fs::symlink_status(head, error))) return Done{};
  fs::create_directory(to / kAuditFolder, error);
  if (error) return io_error("creating " + (to / kAuditFolder).string(), error);
  return copy_file(head, to / kAuditFolder / kAuditHeadName, summary);
}

// Copies regular files and folders only: links do not belong in a data folder and could lead
// anywhere.
Status copy_files(const fs::path& from, const fs::path& to, BackupSummary& summary) {
  std::error_code error;
  fs::recursive_directory_iterator entry(from, error);
  for (; !error && entry != fs::recursive_directory_iterator(); entry.increment(error)) {
    const fs::path relative = entry->path().lexically_relative(from);
    std::error_code gone;
    const fs::file_status status = entry->symlink_status(gone);
    if (is_left_out(relative)) continue;
    if (fs::is_directory(status)) {
      fs::create_directories(to / relative, gone);
      if (gone) return io_error("creating " + (to / relative).string(), gone);
    } else if (fs::is_regular_file(status)) {
      if (Status copied = copy_file(entry->path(), to / relative, summary); !copied.ok())
        return copied;
    }
  }
  if (error) return io_error("reading " + from.string(), error);
  return Done{};
}

// Syncs all folders below `folder`, so that the names in them are durable.
Status sync_folders(const std::string& folder) {
  std::error_code error;
  for (fs::recursive_directory_iterator entry(folder, error), end; !error && entry != end;
       entry.increment(error))
    if (entry->is_directory(error))
      if (Status status = sync_path(entry->path()); !status.ok()) return status;
  if (error) return io_error("reading " + folder, error);
  return sync_path(folder);
}

std::string parent_of(const std::string& path) {
  return (fs::absolute(path) / "").parent_path().parent_path();
}

Result<BackupSummary> copy_all(const std::string& from, const std::string& to) {
  BackupSummary summary;
  const std::string database = to + "/" + kRowsFile;
  // The database goes first: files written later belong to scans that it does not know yet, and do
  // no harm.
  if (Status status = copy_database(from, database); !status.ok()) return status.error();
  const Result<std::int64_t> scan_count = check_database(database);
  if (!scan_count.ok()) return scan_count.error();
  std::error_code error;
  fs::permissions(database, fs::perms::owner_read | fs::perms::owner_write, error);
  if (Status status = sync_path(database); !status.ok()) return status.error();
  summary.scan_count = *scan_count;
  summary.bytes = fs::file_size(database, error);
  if (Status status = copy_audit_head(from, to, summary); !status.ok()) return status.error();
  if (Status status = copy_files(from, to, summary); !status.ok()) return status.error();
  if (Status status = sync_folders(to); !status.ok()) return status.error();
  return summary;
}

Status create_folder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!error) fs::permissions(folder, fs::perms::owner_all, error);
  if (error) return io_error("creating " + folder, error);
  return sync_path(parent_of(folder));
}

Status require_database(const std::string& folder) {
  std::error_code error;
  if (fs::exists(folder + "/" + kRestoreMark, error))
    return Error{ErrorCode::kInvalidArgument,
                 fmt::format("a restore into {} was cut off: restore into it again first", folder)};
  for (const char* name : {kRowsFile, kRowsAt})
    if (fs::is_regular_file(folder + "/" + name, error)) return Done{};
  return Error{ErrorCode::kNotFound, fmt::format("there is no {}/{}", folder, kRowsFile)};
}

}  // namespace

Result<BackupSummary> back_up(const std::string& data, const std::string& backup) {
  if (Status status = require_database(data); !status.ok()) return status.error();
  std::error_code error;
  if (fs::exists(backup, error))
    return Error{ErrorCode::kInvalidArgument,
                 backup + " is there already; a backup needs a new folder"};
  const std::string unfinished = backup + kUnfinished;
  if (fs::exists(unfinished, error))
    return Error{ErrorCode::kInvalidArgument,
                 unfinished + " is left from a backup that was cut off; remove it"};
  if (Status status = create_folder(unfinished); !status.ok()) return status.error();
  Result<BackupSummary> summary = copy_all(data, unfinished);
  if (!summary.ok()) {
    fs::remove_all(unfinished, error);
    return summary;
  }
  fs::rename(unfinished, backup, error);
  if (error) return io_error("renaming " + unfinished, error);
  if (Status status = sync_path(parent_of(backup)); !status.ok()) {
    fs::remove_all(backup, error);
    return status.error();
  }
  return summary;
}

namespace {

// Restores into an existing, empty folder.
Result<BackupSummary> restore_into(const std::string& backup, const std::string& data) {
  const std::string mark = data + "/" + kRestoreMark;
  if (!std::ofstream(mark))
    return io_error("creating " + mark, std::error_code(errno, std::generic_category()));
  if (Status status = sync_path(data); !status.ok()) return status.error();
  Result<BackupSummary> summary = copy_all(backup, data);
  if (!summary.ok()) return summary;
  std::error_code error;
  fs::remove(mark, error);
  if (error) return io_error("removing " + mark, error);
  if (Status status = sync_path(data); !status.ok()) return status.error();
  return summary;
}

Status empty_folder(const std::string& folder) {
  std::error_code error;
  const fs::path mark = fs::path(folder) / kRestoreMark;
  // The mark goes last, so that the remains are never taken for a complete folder.
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, error))
    if (!error && entry.path() != mark) fs::remove_all(entry.path(), error);
  if (!error) fs::remove(mark, error);
  return error ? Status(io_error("emptying " + folder, error)) : Status(Done{});
}

}  // namespace

Result<BackupSummary> restore(const std::string& backup, const std::string& data) {
  if (Status status = require_database(backup); !status.ok()) return status.error();
  if (const Result<std::int64_t> scans = check_database(backup + "/" + kRowsFile); !scans.ok())
    return scans.error();
  std::error_code error;
  if (fs::exists(data + "/" + kRestoreMark, error))
    if (Status status = empty_folder(data); !status.ok()) return status.error();
  if (fs::exists(data, error) && !fs::is_empty(data, error))
    return Error{ErrorCode::kInvalidArgument,
                 data + " is not empty: restore into a new folder, or move this one away first"};
  if (Status status = create_folder(data); !status.ok()) return status.error();
  Result<BackupSummary> summary = restore_into(backup, data);
  // No server must start with an incomplete folder.
  if (!summary.ok())
    if (const Status emptied = empty_folder(data); !emptied.ok()) return emptied.error();
  return summary;
}

}  // namespace hermite::server
