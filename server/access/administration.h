// Tokens and share links as an operator manages them: text in, JSON out, the same over HTTP and for `hermite token` on a data folder that
// no server uses. A secret is in the answer that creates it and never again. Belongs to the thread that owns the store.
//
// The request of a creation is a JSON object; every field may be missing:
//   "name"    for people, at most 100 bytes
//   "scopes"  of a token: a list of "view", "scan", "admin"; ["view", "scan"] when missing
//   "days"    until it expires: a token's 0 to 3650, 0 for never, 365 when missing; a share link's 1 to 365, 7 when missing
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"
#include "server/store/store.h"

namespace hermite {

inline constexpr std::size_t kMaxTokenNameBytes = 100;
inline constexpr int kMaxTokenDays = 3650, kDefaultTokenDays = 365;
inline constexpr int kMaxShareDays = 365, kDefaultShareDays = 7;

// {"token": {"id", "name", "scopes", "created_at", "expires_at", "used_at", "revoked_at", "state"}, "secret"}. Times are null for never,
// state is active, expired or revoked. kInvalidArgument, naming the field and the limit; kBusy: too many; kIo.
Result<std::string> create_token(Store& store, const std::string& request, std::int64_t now_ms, const std::string& made_by = "");

// `made_by`: id of the token that asks, for which a share link counts; empty: the owner of the data folder.
// {"share": {as a token, "scan"}, "secret", "path"}; the path is what stands behind the server's address in the link: the secret is in the
// fragment, which browsers do not send. kNotFound: no such scan.
Result<std::string> create_share(Store& store, const std::string& scan_id, const std::string& request, std::int64_t now_ms,
                                 const std::string& made_by = "");

// {"tokens": [...]} and {"shares": [...]}, newest first. `scan_id`: only that scan's; empty: all.
Result<std::string> list_tokens(Store& store, std::int64_t now_ms);
Result<std::string> list_shares(Store& store, const std::string& scan_id, std::int64_t now_ms);

// {"revoked": id}. kNotFound: there is none, or it is of the other kind. A running server does not know of it: Gate::forget_grants.
Result<std::string> revoke_row(Store& store, const std::string& id, bool share, std::int64_t now_ms);

}  // namespace hermite
