// Authentication and authorisation: the only place where secrets become grants. Belongs to the
// network thread; the time is an argument.
//
// A correct secret is always accepted, however many wrong ones came from its address: behind a
// proxy all clients share one address, and nobody guesses 256 bits. Only the cost of wrong ones is
// limited: beyond a rate the answer is to wait, not that they are wrong.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "server/access/rate_limit.h"
#include "server/store/store.h"

namespace hermite::server {

// The permissions of the owner of a token or share link.
struct Grant {
  std::string token_id;
  Scopes scopes;
  std::string scan_id;             // of a share link: the only scan that it gives access to
  std::int64_t expires_at_ms = 0;  // 0: never
};

bool may(const Grant& grant, Scope scope);

// Returns false for the share link of another scan.
bool concerns(const Grant& grant, const std::string& scan_id);

// Returns whether `scan_id` may be viewed. Otherwise the client is told that there is no such scan.
bool may_see(const Grant& grant, const std::string& scan_id);

// Returns an error like "this token allows view; admin is needed".
Error lacks(const Grant& grant, Scope needed);

// A client that asks for access.
struct Caller {
  std::string address;  // wrong secrets are counted by it
  std::int64_t now_ms = 0;
  std::string peer = {};  // the full address, for the audit log; `address` may be that of a network
};

// Writing a row to disk for every request would be expensive.
inline constexpr std::int64_t kLastUsePrecision_ms = 60'000;

// Whether admit() failed because the store did, which says nothing of the secret.
inline bool is_of_store(const Error& error) {
  return error.code == ErrorCode::kIo || error.code == ErrorCode::kUnavailable;
}

class Gate {
 public:
  // Allows `failures_per_minute` wrong secrets per address, and that many at once. `store` outlives
  // this.
  Gate(Store& store, int failures_per_minute);

  // Makes the row of the first token match the secret of its file: a new secret replaces the old
  // one. Throws SetupError if the store fails. Returns false if that token was revoked, which it
  // remains.
  bool install_first_token(const std::string& secret, std::int64_t now_ms);

  // kUnauthorized: unknown, expired or revoked, with the same message, since a client without
  // access must not learn which. kBusy: the same, but there were too many. kIo, kUnavailable: the
  // store failed. Never logs the secret.
  Result<Grant> admit(std::string_view secret, const Caller& caller);

  // `told` is called for every wrong secret, also when the answer is to wait. Set it before the
  // first call of admit().
  void on_wrong_secret(std::function<void(const Caller&)> told) {
    on_wrong_secret_ = std::move(told);
  }

  // Returns after how long a further wrong secret of an address is again answered as wrong, not
  // with kBusy.
  std::int64_t failure_wait_ms() const { return failure_wait_ms_; }

  // Returns whether a grant is still valid: neither expired nor revoked.
  bool holds(const Grant& grant, std::int64_t now_ms) const;

  // To be called after a token was revoked in the store: its grants become invalid.
  void forget_grants(const std::string& token_id);

 private:
  Store& store_;
  const std::int64_t failure_wait_ms_;
  RateLimit failures_;
  std::function<void(const Caller&)> on_wrong_secret_ = [](const Caller&) {};
  // Tokens revoked since the start; earlier grants of these tokens are invalid.
  std::set<std::string> revoked_ids_;
};

}  // namespace hermite::server
