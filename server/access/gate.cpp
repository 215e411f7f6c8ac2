#include "server/access/gate.h"

#include <fmt/core.h>
#include <spdlog/spdlog.h>

#include "core/digest/sha256.h"
#include "server/access/access.h"
#include "server/store/secret.h"
#include "server/store/unix_time.h"

namespace hermite::server {

namespace {

constexpr std::int64_t kForgetAfter_ms = 90 * kDay_ms;  // how long ended tokens stay in the list

std::string names_of(const Scopes& scopes) {
  std::string names;
  for (const Scope scope : kAllScopes)
    if (includes(scopes, scope)) names += (names.empty() ? "" : ", ") + std::string(name_of(scope));
  return names;
}

bool ended(const TokenRow& row, std::int64_t now_ms) {
  return row.revoked_at_ms != 0 || (row.expires_at_ms != 0 && now_ms >= row.expires_at_ms);
}

void must(const Status& status) {
  if (!status.ok()) throw SetupError(status.error());
}

}  // namespace

bool may(const Grant& grant, Scope scope) { return includes(grant.scopes, scope); }

bool concerns(const Grant& grant, const std::string& scan_id) {
  return grant.scan_id.empty() || grant.scan_id == scan_id;
}

bool may_see(const Grant& grant, const std::string& scan_id) {
  return may(grant, Scope::kView) && concerns(grant, scan_id);
}

Error lacks(const Grant& grant, Scope needed) {
  return {ErrorCode::kUnauthorized, fmt::format("this token allows {}; {} is needed",
                                                names_of(grant.scopes), name_of(needed))};
}

Gate::Gate(Store& store, int failures_per_minute)
    : store_(store),
      failure_wait_ms_(60'000 / failures_per_minute),
      failures_(failures_per_minute / 60.0, failures_per_minute) {}

bool Gate::install_first_token(const std::string& secret, std::int64_t now_ms) {
  const Result<int> forgotten = store_.tokens.forget(now_ms - kForgetAfter_ms);
  if (!forgotten.ok()) throw SetupError(forgotten.error());
  const std::string hash = digest::sha256(secret);
  const Result<TokenRow> row = store_.tokens.find(kFirstTokenId);
  if (!row.ok() && row.error().code != ErrorCode::kNotFound) throw SetupError(row.error());
  if (row.ok() && row->secret_sha256 == hash) return row->revoked_at_ms == 0;
  if (row.ok()) must(store_.tokens.remove(kFirstTokenId));
  TokenRow first;
  first.id = kFirstTokenId;
  first.secret_sha256 = hash;
  first.name = "made at the first start, in the file token";
  first.scopes = {true, true, true};
  first.created_at_ms = now_ms;
  must(store_.tokens.add(first));
  return true;
}

Result<Grant> Gate::admit(std::string_view secret, const Caller& caller) {
  const std::string hash = digest::sha256(secret);
  const Result<TokenRow> row = store_.tokens.with_secret(hash);
  if (!row.ok() && row.error().code != ErrorCode::kNotFound) return row.error();
  // The duration of the search depends on hashes, which an attacker cannot choose; the comparison
  // takes constant time.
  if (row.ok() && tokens_equal(row->secret_sha256, hash) && !ended(*row, caller.now_ms)) {
    if (caller.now_ms - row->used_at_ms >= kLastUsePrecision_ms)
      if (const Status noted = store_.tokens.touch(row->id, caller.now_ms); !noted.ok())
        spdlog::warn("last use of token {}: {}", row->id, noted.error().message);
    return Grant{row->id, row->scopes, row->scan_id, row->expires_at_ms};
  }
  on_wrong_secret_(caller);
  if (const std::int64_t wait_ms = failures_.take(caller.address, caller.now_ms); wait_ms > 0)
    return Error{ErrorCode::kBusy,
                 fmt::format("too many wrong tokens from this address; try again in {} s",
                             (wait_ms + 999) / 1000)};
  spdlog::info("a wrong token from {}{}", caller.address,
               row.ok() ? fmt::format(" ({}, which has ended)", row->id) : "");
  return Error{ErrorCode::kUnauthorized,
               "this is no token or share link of this server, or it has expired or was revoked"};
}

bool Gate::holds(const Grant& grant, std::int64_t now_ms) const {
  return !revoked_ids_.contains(grant.token_id) &&
         (grant.expires_at_ms == 0 || now_ms < grant.expires_at_ms);
}

void Gate::forget_grants(const std::string& token_id) { revoked_ids_.insert(token_id); }

}  // namespace hermite::server
