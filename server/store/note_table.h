// The rows of notes in scans. Contract and errors: store.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/database/database.h"
#include "server/store/note_row.h"

namespace hermite::server {

class NoteTable {
 public:
  explicit NoteTable(Database& database) : database_(database) {}

  // At most kMaxNotesPerScan. kNotFound: no such scan. kBusy: it has that many already.
  // kInvalidArgument: the id exists already, or a number is NaN.
  Status add(const NoteRow& row);
  // Oldest first, those of the same millisecond by their ids; empty if it has none.
  Result<std::vector<NoteRow>> of_scan(const std::string& scan_id);
  // Writes the text and changed_at_ms of `row` into the note if that has the version of `row`,
  // which then grows by 1. kNotFound: the scan has no such note.
  Result<NoteOutcome> change_text(const NoteRow& row);
  // Removes a note if it has this version. kNotFound as above.
  Result<NoteOutcome> remove(const std::string& scan_id, const std::string& id,
                             std::int64_t version);

 private:
  Database& database_;
};

}  // namespace hermite::server
