#include "server/store/upload_table.h"

#include "server/store/table_tools.h"

namespace hermite::server {

namespace {

constexpr const char* kUploadColumns =
    "id, token_id, length_bytes, metadata, unchecked_from, created_at_ms, expires_at_ms";
const std::string kSelectUploads = std::string("SELECT ") + kUploadColumns + " FROM uploads ";

std::vector<SqlValue> values_of(const UploadRow& row) {
  return {row.id,           row.token_id,       row.length_bytes,
          row.metadata,     row.unchecked_from, row.created_at_ms,
          row.expires_at_ms};
}

UploadRow upload_row_of(const SqlRow& values) {
  RowReader next(values);
  UploadRow row;
  row.id = next.text();
  row.token_id = next.text();
  row.length_bytes = next.integer();
  row.metadata = next.text();
  row.unchecked_from = next.integer();
  row.created_at_ms = next.integer();
  row.expires_at_ms = next.integer();
  return row;
}

Error no_upload(const std::string& id) {
  return {ErrorCode::kNotFound, "there is no upload " + id};
}

}  // namespace

Status UploadTable::add(const UploadRow& row) {
  return change(database_, "upload " + row.id, [&]() -> Status {
    const Taken taken =
        taken_of(database_, "SELECT count(*), count(*) FILTER (WHERE token_id = $1) FROM uploads",
                 {row.token_id});
    if (Status status =
            check_share(kUploadShare, taken, may_administer(database_, row.token_id), "uploads");
        !status.ok())
      return status;
    database_.run(insertion("uploads", kUploadColumns), values_of(row));
    return Done{};
  });
}

Status UploadTable::update(const UploadRow& row) {
  return change(database_, "upload " + row.id, [&] {
    return changed_or(
        database_.run("UPDATE uploads SET length_bytes = $1, unchecked_from = $2, expires_at_ms = "
                      "$3 WHERE id = $4",
                      {row.length_bytes, row.unchecked_from, row.expires_at_ms, row.id}),
        no_upload(row.id));
  });
}

Result<UploadRow> UploadTable::find(const std::string& id) {
  return read(database_, [&]() -> Result<UploadRow> {
    const SqlResult result = database_.run(kSelectUploads + "WHERE id = $1", {id});
    if (result.rows.empty()) return no_upload(id);
    return upload_row_of(result.rows.front());
  });
}

Status UploadTable::remove(const std::string& id) {
  return change(database_, "upload " + id, [&] {
    return changed_or(database_.run("DELETE FROM uploads WHERE id = $1", {id}), no_upload(id));
  });
}

Result<std::vector<UploadRow>> UploadTable::list() {
  return read(database_, [&] {
    return rows_of(database_.run(kSelectUploads + "ORDER BY created_at_ms, id"), upload_row_of);
  });
}

}  // namespace hermite::server
