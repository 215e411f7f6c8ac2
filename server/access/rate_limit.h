// Limits the rate of events per address, with bursts. Plain values; belong to one thread; the time
// is an argument.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "core/base/result.h"
#include "server/store/shares.h"

namespace hermite::server {

// Limit on addresses that are tracked separately. Beyond it the other active ones share one
// allowance, which bounds memory.
inline constexpr std::size_t kMaxLimitedAddresses = 4096;

class RateLimit {
 public:
  // Allows `burst` events at once, then `per_second`, which is above 0.
  RateLimit(double per_second, double burst);

  // Takes one event. Returns 0 if it is allowed, otherwise after how many milliseconds one will be.
  // `now_ms` may jump.
  std::int64_t take(const std::string& address, std::int64_t now_ms);

  std::size_t remembered_count() const { return allowances_.size(); }

 private:
  struct Allowance {
    double left;
    std::int64_t at_ms;
  };
  Allowance refilled(const Allowance& allowance, std::int64_t now_ms) const;
  void forget_idle(std::int64_t now_ms);

  const double per_ms_, burst_;
  std::map<std::string, Allowance> allowances_;
  std::int64_t forgotten_at_ms_ = 0;  // when idle addresses were last removed
};

// Limits how many things each address has open.
class CountLimit {
 public:
  CountLimit(int in_all, int per_address) : in_all_(in_all), per_address_(per_address) {}

  // Returns false if that would be too many; otherwise leave() must follow. The empty address is
  // subject only to the total limit.
  bool enter(const std::string& address);
  void leave(const std::string& address);
  int count() const { return count_; }

 private:
  const int in_all_, per_address_;
  int count_ = 0;
  std::map<std::string, int> counts_;  // at most in_all_ entries
};

// Limits how many things each token has open to its share (shares.h).
class ShareCount {
 public:
  explicit ShareCount(const Share& share) : share_(share) {}

  // Releases its place when destroyed; the ShareCount outlives it.
  class Place {
   public:
    Place(ShareCount& count, std::string token_id)
        : count_(count), token_id_(std::move(token_id)) {}
    ~Place() { count_.leave(token_id_); }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

   private:
    ShareCount& count_;
    const std::string token_id_;
  };

  // kBusy, with a message that includes `things`.
  Result<std::unique_ptr<Place>> enter(const std::string& token_id, bool is_admin,
                                       const std::string& things);

 private:
  void leave(const std::string& token_id);

  const Share share_;
  std::int64_t count_ = 0;
  std::map<std::string, std::int64_t> counts_;  // of tokens that have any open
};

}  // namespace hermite::server
