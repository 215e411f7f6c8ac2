#include "server/store/token_table.h"

#include "server/store/table_tools.h"

namespace hermite::server {

namespace {

constexpr const char* kTokenColumns =
    "id, secret_sha256, name, may_view, may_scan, may_admin, scan_id, created_at_ms, "
    "expires_at_ms, used_at_ms, revoked_at_ms, made_by";
const std::string kSelectTokens = std::string("SELECT ") + kTokenColumns + " FROM tokens ";

std::vector<SqlValue> values_of(const TokenRow& row) {
  return {row.id,
          SqlBytes{row.secret_sha256},
          row.name,
          row.scopes.view,
          row.scopes.scan,
          row.scopes.admin,
          row.scan_id.empty() ? SqlValue() : SqlValue(row.scan_id),
          row.created_at_ms,
          row.expires_at_ms,
          row.used_at_ms,
          row.revoked_at_ms,
          row.made_by};
}

TokenRow token_row_of(const SqlRow& values) {
  RowReader next(values);
  TokenRow row;
  row.id = next.text();
  row.secret_sha256 = next.bytes();
  row.name = next.text();
  row.scopes.view = next.flag();
  row.scopes.scan = next.flag();
  row.scopes.admin = next.flag();
  row.scan_id = next.text_or_null();
  row.created_at_ms = next.integer();
  row.expires_at_ms = next.integer();
  row.used_at_ms = next.integer();
  row.revoked_at_ms = next.integer();
  row.made_by = next.text();
  return row;
}

Error no_token(const std::string& id) {
  return {ErrorCode::kNotFound, "there is no token or share link " + id};
}

// Runs `sql`, which changes the token `id`.
Status change_token(Database& database, const std::string& id, const std::string& sql,
                    const std::vector<SqlValue>& values) {
  return change(database, "token " + id,
                [&] { return changed_or(database.run(sql, values), no_token(id)); });
}

Status check_scan(Database& database, const std::string& scan_id) {
  if (scan_id.empty() || !database.run("SELECT 1 FROM scans WHERE id = $1", {scan_id}).rows.empty())
    return Done{};
  return Error{ErrorCode::kNotFound, "there is no scan " + scan_id};
}

// Checks whether the creator of the row may have one more. Tokens and share links are counted
// separately.
Status check_token_share(Database& database, const TokenRow& row) {
  const bool is_link = !row.scan_id.empty();
  const Taken taken =
      taken_of(database,
               std::string("SELECT count(*), count(*) FILTER (WHERE made_by = $1) FROM tokens "
                           "WHERE revoked_at_ms = 0 AND "
                           "(expires_at_ms = 0 OR expires_at_ms > $2) AND scan_id IS ") +
                   (is_link ? "NOT NULL" : "NULL"),
               {row.made_by, row.created_at_ms});
  return check_share(is_link ? kShareLinkShare : kTokenShare, taken,
                     may_administer(database, row.made_by),
                     is_link ? "share links that have not ended" : "tokens that have not ended");
}

// Keeps only the newest kMaxEndedLinksPerToken ended ones of a creator. The first token always
// stays; otherwise the secret in its file would become valid again.
void forget_surplus_tokens(Database& database, const std::string& made_by, std::int64_t now_ms) {
  database.run(std::string("DELETE FROM tokens WHERE id IN (SELECT id FROM tokens WHERE made_by = "
                           "$1 AND id <> $2 AND "
                           "(revoked_at_ms > 0 OR (expires_at_ms > 0 AND expires_at_ms <= $3)) "
                           "ORDER BY created_at_ms DESC, id LIMIT ") +
                   kNoLimit + " OFFSET $4)",
               {made_by, kFirstTokenId, now_ms, kMaxEndedLinksPerToken});
}

Result<TokenRow> token_of(const SqlResult& result, const Error& otherwise) {
  if (result.rows.empty()) return otherwise;
  return token_row_of(result.rows.front());
}

}  // namespace

Status TokenTable::add(const TokenRow& row) {
  return change(database_, "token " + row.id, [&]() -> Status {
    if (Status status = check_scan(database_, row.scan_id); !status.ok()) return status;
    if (Status status = check_token_share(database_, row); !status.ok()) return status;
    database_.run(insertion("tokens", kTokenColumns), values_of(row));
    forget_surplus_tokens(database_, row.made_by, row.created_at_ms);
    return Done{};
  });
}

Result<TokenRow> TokenTable::with_secret(const std::string& secret_sha256) {
  return read(database_, [&] {
    return token_of(
        database_.run(kSelectTokens + "WHERE secret_sha256 = $1", {SqlBytes{secret_sha256}}),
        {ErrorCode::kNotFound, "there is no token with this secret"});
  });
}

Result<TokenRow> TokenTable::find(const std::string& id) {
  return read(database_, [&] {
    return token_of(database_.run(kSelectTokens + "WHERE id = $1", {id}), no_token(id));
  });
}

Result<std::vector<TokenRow>> TokenTable::list() {
  return read(database_, [&] {
    return rows_of(database_.run(kSelectTokens + "ORDER BY created_at_ms DESC, id"), token_row_of);
  });
}

Status TokenTable::revoke(const std::string& id, std::int64_t now_ms) {
  return change_token(database_, id,
                      "UPDATE tokens SET revoked_at_ms = CASE WHEN revoked_at_ms = 0 THEN $1 ELSE "
                      "revoked_at_ms END WHERE id = $2",
                      {now_ms, id});
}

Status TokenTable::touch(const std::string& id, std::int64_t now_ms) {
  return change_token(database_, id, "UPDATE tokens SET used_at_ms = $1 WHERE id = $2",
                      {now_ms, id});
}

Status TokenTable::remove(const std::string& id) {
  return change_token(database_, id, "DELETE FROM tokens WHERE id = $1", {id});
}

Result<int> TokenTable::forget(std::int64_t ended_before_ms) {
  return change(database_, "tokens", [&]() -> Result<int> {
    return database_
        .run(
            "DELETE FROM tokens WHERE id <> $1 AND ((revoked_at_ms > 0 AND revoked_at_ms < $2) OR "
            "(expires_at_ms > 0 AND expires_at_ms < $2))",
            {kFirstTokenId, ended_before_ms})
        .changed_count;
  });
}

}  // namespace hermite::server
