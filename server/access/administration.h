// Manages tokens and share links: JSON in, JSON out, the same for the HTTP API and for `hermite
// token` on a data folder that no server uses. A secret is part of the answer that creates it and
// never shown again. Belongs to the thread that owns the store.
//
// A request to create one is a JSON object, all of whose members are optional:
//   "name"    display name, at most 100 bytes
//   "scopes"  of a token: a list of "view", "scan", "admin"; default ["view", "scan"]
//   "days"    until it expires: of a token 0 to 3650, 0 for never, default 365; of a share link 1
//             to 365, default 7
#pragma once

#include <cstdint>
#include <string>

#include "core/base/result.h"
#include "server/store/store.h"

namespace hermite::server {

inline constexpr std::size_t kMaxTokenNameBytes = 100;
inline constexpr int kMaxTokenDays = 3650, kDefaultTokenDays = 365;
inline constexpr int kMaxShareDays = 365, kDefaultShareDays = 7;

// Returns {"token": {"id", "name", "scopes", "created_at", "expires_at", "used_at", "revoked_at",
// "state"}, "secret"}. Times are null for never; state is active, expired or revoked.
// kInvalidArgument, naming the member and the limit; kBusy: too many; kIo.
Result<std::string> create_token(Store& store, const std::string& request, std::int64_t now_ms,
                                 const std::string& made_by = "");

// `made_by` is the id of the requesting token, whose share the link counts towards; empty: the
// owner of the data folder. Returns {"share": {as a token, "scan"}, "secret", "path"}; the path is
// what follows the server's address in the link: the secret is in the fragment, which browsers do
// not send. kNotFound: no such scan.
Result<std::string> create_share(Store& store, const std::string& scan_id,
                                 const std::string& request, std::int64_t now_ms,
                                 const std::string& made_by = "");

// Return {"tokens": [...]} and {"shares": [...]}, newest first. `scan_id`: only those of that scan;
// empty: all.
Result<std::string> list_tokens(Store& store, std::int64_t now_ms);
Result<std::string> list_shares(Store& store, const std::string& scan_id, std::int64_t now_ms);

// Returns {"revoked": id}. kNotFound: there is none, or it is of the other kind. A running server
// must be told separately: Gate::forget_grants.
Result<std::string> revoke_row(Store& store, const std::string& id, bool share,
                               std::int64_t now_ms);

}  // namespace hermite::server
