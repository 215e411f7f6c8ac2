// The part of SqliteStore for tokens and share links.
#include <sqlite3.h>

#include <initializer_list>

#include "server/store/sqlite_connection.h"

namespace hermite {

namespace {

constexpr const char* kTokenColumns =
    "id, secret_sha256, name, may_view, may_scan, may_admin, coalesce(scan_id, ''), created_at_ms, expires_at_ms, used_at_ms, "
    "revoked_at_ms, made_by";

TokenRow token_row_of(const SQLite::Statement& query) {
  TokenRow row;
  row.id = query.getColumn(0).getString();
  row.secret_sha256 = query.getColumn(1).getString();
  row.name = query.getColumn(2).getString();
  row.scopes = {query.getColumn(3).getInt() != 0, query.getColumn(4).getInt() != 0, query.getColumn(5).getInt() != 0};
  row.scan_id = query.getColumn(6).getString();
  row.created_at_ms = query.getColumn(7).getInt64();
  row.expires_at_ms = query.getColumn(8).getInt64();
  row.used_at_ms = query.getColumn(9).getInt64();
  row.revoked_at_ms = query.getColumn(10).getInt64();
  row.made_by = query.getColumn(11).getString();
  return row;
}

Error no_token(const std::string& id) { return {ErrorCode::kNotFound, "there is no token or share link " + id}; }

// Runs `sql`, which changes the token with the id that is its last parameter; `values` are the parameters before.
Status change_token(SQLite::Database& database, const char* sql, std::initializer_list<std::int64_t> values, const std::string& id) try {
  SQLite::Statement change(database, sql);
  int column = 0;
  for (const std::int64_t value : values) change.bind(++column, value);
  change.bind(++column, id);
  if (change.exec() == 0) return no_token(id);
  return Done{};
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

// Checks whether the creator of the row may have one more. Tokens and share links are counted separately.
Status check_token_share(SQLite::Database& database, const TokenRow& row) {
  const bool is_link = !row.scan_id.empty();
  SQLite::Statement count(database, std::string("SELECT count(*), coalesce(sum(made_by = ?1), 0) FROM tokens WHERE revoked_at_ms = 0 AND "
                                                "(expires_at_ms = 0 OR expires_at_ms > ?2) AND scan_id IS ") +
                                        (is_link ? "NOT NULL" : "NULL"));
  count.bind(2, row.created_at_ms);
  const Taken taken = taken_of(count, row.made_by);
  return check_share(is_link ? kShareLinkShare : kTokenShare, taken, may_administer(database, row.made_by),
                     is_link ? "share links that have not ended" : "tokens that have not ended");
}

// Keeps only the newest kMaxEndedLinksPerToken ended ones of a creator. The first token always stays; otherwise the
// secret in its file would become valid again.
void forget_more_than_enough(SQLite::Database& database, const std::string& made_by, std::int64_t now_ms) {
  SQLite::Statement change(database,
                           "DELETE FROM tokens WHERE id IN (SELECT id FROM tokens WHERE made_by = ?1 AND id <> ?2 AND "
                           "(revoked_at_ms > 0 OR (expires_at_ms > 0 AND expires_at_ms <= ?3)) "
                           "ORDER BY created_at_ms DESC, id LIMIT -1 OFFSET ?4)");
  change.bind(1, made_by);
  change.bind(2, std::string(kFirstTokenId));
  change.bind(3, now_ms);
  change.bind(4, kMaxEndedLinksPerToken);
  change.exec();
}

}  // namespace

bool may_administer(SQLite::Database& database, const std::string& token_id) {
  if (token_id.empty()) return true;
  SQLite::Statement query(database, "SELECT may_admin FROM tokens WHERE id = ?");
  query.bind(1, token_id);
  return query.executeStep() && query.getColumn(0).getInt() != 0;
}

Taken taken_of(SQLite::Statement& count, const std::string& token_id) {
  count.bind(1, token_id);
  count.executeStep();
  return {count.getColumn(0).getInt64(), count.getColumn(1).getInt64()};
}

Status SqliteStore::add_token(const TokenRow& row) try {
  SQLite::Database& database = impl_->database;
  if (!row.scan_id.empty())
    if (const Result<ScanRow> scan = find(row.scan_id); !scan.ok()) return scan.error();
  SQLite::Transaction transaction(database, SQLite::TransactionBehavior::IMMEDIATE);
  if (Status status = check_token_share(database, row); !status.ok()) return status;
  SQLite::Statement insert(database,
                           "INSERT INTO tokens(id, secret_sha256, name, may_view, may_scan, may_admin, scan_id, created_at_ms, "
                           "expires_at_ms, used_at_ms, revoked_at_ms, made_by) VALUES(?,?,?,?,?,?,nullif(?,''),?,?,?,?,?)");
  int column = 0;
  insert.bind(++column, row.id);
  insert.bind(++column, row.secret_sha256.data(), static_cast<int>(row.secret_sha256.size()));
  insert.bind(++column, row.name);
  for (const bool may : {row.scopes.view, row.scopes.scan, row.scopes.admin}) insert.bind(++column, may ? 1 : 0);
  insert.bind(++column, row.scan_id);
  for (const std::int64_t time_ms : {row.created_at_ms, row.expires_at_ms, row.used_at_ms, row.revoked_at_ms})
    insert.bind(++column, time_ms);
  insert.bind(++column, row.made_by);
  insert.exec();
  forget_more_than_enough(database, row.made_by, row.created_at_ms);
  transaction.commit();
  return Done{};
} catch (const SQLite::Exception& failure) {
  if (failure.getErrorCode() == SQLITE_CONSTRAINT) return Error{ErrorCode::kInvalidArgument, "token " + row.id + ": " + failure.what()};
  return database_error(failure);
}

Result<TokenRow> SqliteStore::find_token(const std::string& secret_sha256) try {
  SQLite::Statement query(impl_->database, std::string("SELECT ") + kTokenColumns + " FROM tokens WHERE secret_sha256 = ?");
  query.bind(1, secret_sha256.data(), static_cast<int>(secret_sha256.size()));
  if (!query.executeStep()) return Error{ErrorCode::kNotFound, "there is no token with this secret"};
  return token_row_of(query);
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<TokenRow> SqliteStore::token(const std::string& id) try {
  SQLite::Statement query(impl_->database, std::string("SELECT ") + kTokenColumns + " FROM tokens WHERE id = ?");
  query.bind(1, id);
  if (!query.executeStep()) return no_token(id);
  return token_row_of(query);
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

Result<std::vector<TokenRow>> SqliteStore::list_tokens() try {
  SQLite::Statement query(impl_->database, std::string("SELECT ") + kTokenColumns + " FROM tokens ORDER BY created_at_ms DESC, id");
  std::vector<TokenRow> rows;
  while (query.executeStep()) rows.push_back(token_row_of(query));
  return rows;
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

// Keeps the time of the first revocation.
Status SqliteStore::revoke_token(const std::string& id, std::int64_t now_ms) {
  return change_token(impl_->database, "UPDATE tokens SET revoked_at_ms = iif(revoked_at_ms = 0, ?, revoked_at_ms) WHERE id = ?", {now_ms},
                      id);
}

Status SqliteStore::touch_token(const std::string& id, std::int64_t now_ms) {
  return change_token(impl_->database, "UPDATE tokens SET used_at_ms = ? WHERE id = ?", {now_ms}, id);
}

Status SqliteStore::remove_token(const std::string& id) { return change_token(impl_->database, "DELETE FROM tokens WHERE id = ?", {}, id); }

Result<int> SqliteStore::forget_tokens(std::int64_t ended_before_ms) try {
  SQLite::Statement change(impl_->database,
                           "DELETE FROM tokens WHERE id <> ? AND ((revoked_at_ms > 0 AND revoked_at_ms < ?) OR "
                           "(expires_at_ms > 0 AND expires_at_ms < ?))");
  change.bind(1, std::string(kFirstTokenId));
  change.bind(2, ended_before_ms);
  change.bind(3, ended_before_ms);
  return change.exec();
} catch (const SQLite::Exception& failure) {
  return database_error(failure);
}

}  // namespace hermite
