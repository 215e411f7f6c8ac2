// What a server stores besides files: one row per scan, token, upload, measurement, note and job.
// Rows outlive the server. They are in a database (server/database): SQLite or PostgreSQL. The
// tests in tests/server/store/store_contract.h apply to both.
//
// The tables guarantee:
//   atomic    Each call is one transaction. A call that returns an error has changed nothing,
//             except after kIo: the change may still appear, if a disk failed to sync, after a
//             restart, and if the connection to a database was lost, where the message says so.
//             Limits and keys are checked in the same transaction that uses them. No transaction
//             spans two calls: rows that must agree are written in an order in which a crash in
//             between does no harm (the job of an upload has the id of the upload, so that it is
//             added only once however often that is tried).
//   durable   A change whose call succeeded survives the death of the process, and that of the
//             machine if its disk honours syncs.
//   in order  A call sees all changes of earlier calls, and none of later ones.
//   one user  A store belongs to one thread at a time, and to one server. Only check_integrity()
//             may be called on another thread meanwhile.
//
// Errors, unless stated otherwise: kUnavailable when the database cannot be reached, kIo for every
// other failure, both with its message. Ids and secrets are compared byte by byte.
#pragma once

#include <memory>
#include <string>

#include "core/base/result.h"
#include "server/database/database.h"
#include "server/store/job_table.h"
#include "server/store/measurement_table.h"
#include "server/store/note_table.h"
#include "server/store/scan_table.h"
#include "server/store/token_table.h"
#include "server/store/upload_table.h"

namespace hermite::server {

class Store {
  const std::unique_ptr<Database> database_;  // before the tables, which refer to it

 public:
  explicit Store(std::unique_ptr<Database> database);
  // Opens the SQLite file (sqlite_database.h). Throws SetupError.
  explicit Store(const std::string& sqlite_path);

  ScanTable scans{*database_};
  TokenTable tokens{*database_};
  UploadTable uploads{*database_};
  MeasurementTable measurements{*database_};
  JobTable jobs{*database_};
  NoteTable notes{*database_};

  // As of Database.
  Status check_writable() { return database_->check_writable(); }
  Status check_integrity() const { return database_->check_integrity(); }
};

}  // namespace hermite::server
