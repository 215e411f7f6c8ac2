// Who is let in and what they may do: secrets become grants here and nowhere else. Belongs to the network thread; time comes in from
// outside.
//
// A right secret is always let in, however many wrong ones came from its address: behind a proxy all come from one, and nobody guesses
// 256 bits. What is limited is what wrong ones cost: too many are told to wait instead of being told that they are wrong.
#pragma once

#include <cstdint>
#include <functional>
#include <set>
#include <string>
#include <string_view>

#include "core/base/result.h"
#include "server/access/rate_limit.h"
#include "server/store/store.h"

namespace hermite {

// What the owner of a token or share link may do.
struct Grant {
  std::string token_id;
  Scopes scopes;
  std::string scan_id;             // of a share link: the only scan there is for it
  std::int64_t expires_at_ms = 0;  // 0: never
};

bool may(const Grant& grant, Scope scope);

// False for a share link of another scan.
bool concerns(const Grant& grant, const std::string& scan_id);

// Whether `scan_id` may be looked at. Who may not see a scan is told that there is none.
bool may_see(const Grant& grant, const std::string& scan_id);

// "this token allows view; admin is needed"
Error lacks(const Grant& grant, Scope needed);

// Somebody at the door.
struct Caller {
  std::string address;  // wrong secrets are counted by it
  std::int64_t now_ms = 0;
  std::string peer = {};  // the whole address, for the audit log; `address` may be that of a network
};

inline constexpr std::int64_t kLastUsePrecision_ms = 60'000;  // a row written to disk for every request would be dear

class Gate {
 public:
  // `failures_per_minute` wrong secrets an address, so many at once. `store` outlives this.
  Gate(Store& store, int failures_per_minute);

  // Makes the first token's row fit the file's secret: a new secret replaces the old one. Throws SetupError when the store cannot.
  // False: that token was revoked and stays so.
  bool install_first_token(const std::string& secret, std::int64_t now_ms);

  // kUnauthorized: unknown, expired or revoked, in the same words, since who has no right shall not learn which. kBusy: and one of too
  // many. kIo: the store. Never logs the secret.
  Result<Grant> admit(std::string_view secret, const Caller& caller);

  // Told of every wrong secret, also of those that are told to wait. Set before the first caller.
  void on_wrong_secret(std::function<void(const Caller&)> told) { on_wrong_secret_ = std::move(told); }

  // After how long one more wrong secret of an address is told that it is wrong.
  std::int64_t failure_wait_ms() const { return failure_wait_ms_; }

  // Whether what was granted still holds: neither expired nor forgotten.
  bool holds(const Grant& grant, std::int64_t now_ms) const;

  // After the revocation of a token in the store: what was granted to it no longer holds.
  void forget_grants(const std::string& token_id);

 private:
  Store& store_;
  const std::int64_t failure_wait_ms_;
  RateLimit failures_;
  std::function<void(const Caller&)> on_wrong_secret_ = [](const Caller&) {};
  std::set<std::string> revoked_ids_;  // since the start; what was granted before must end
};

}  // namespace hermite
