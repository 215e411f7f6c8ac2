// The rows of tokens and share links. Contract and errors: store.h.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "core/base/result.h"
#include "server/database/database.h"
#include "server/store/token_row.h"

namespace hermite::server {

// Tokens and links that have ended (revoked or expired) count for no limit, and stay in the list
// until they are forgotten or there are kMaxEndedLinksPerToken newer ended ones of the same
// creator. The part of a limit that is reserved for administrators (shares.h) is available to a
// creator whose row has the scope admin, and to an empty creator, which is the owner of the data
// folder. kNotFound, unless stated otherwise: there is no such token.
class TokenTable {
 public:
  explicit TokenTable(Database& database) : database_(database) {}

  // kInvalidArgument: the id or the secret exists already. kNotFound: no such scan. kBusy: the
  // share of the creator is used up. The current time is taken from the row's created_at_ms.
  Status add(const TokenRow& row);
  // Also returns revoked and expired ones.
  Result<TokenRow> with_secret(const std::string& secret_sha256);
  Result<TokenRow> find(const std::string& id);
  Result<std::vector<TokenRow>> list();  // newest first
  // Keeps the time of the first revocation.
  Status revoke(const std::string& id, std::int64_t now_ms);
  Status touch(const std::string& id, std::int64_t now_ms);  // sets the last use
  Status remove(const std::string& id);
  // Removes those revoked or expired before that time, except the first token. Returns their
  // number.
  Result<int> forget(std::int64_t ended_before_ms);

 private:
  Database& database_;
};

}  // namespace hermite::server
