// So many events a second for each address, and so many at once. Plain values; belongs to one thread; time comes in from outside.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "core/base/result.h"
#include "server/store/shares.h"

namespace hermite {

// Addresses that are remembered one by one. With more of them active the rest share one allowance: memory stays bounded.
inline constexpr std::size_t kMaxLimitedAddresses = 4096;

class RateLimit {
 public:
  // `burst` events at once, and then `per_second`, above 0.
  RateLimit(double per_second, double burst);

  // Takes one event. 0: it is allowed; else it is not, and in so many milliseconds one will be. `now_ms` may jump.
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
  std::int64_t forgotten_at_ms_ = 0;  // the last time that the idle were
};

// How many of something each address has open.
class CountLimit {
 public:
  CountLimit(int in_all, int per_address) : in_all_(in_all), per_address_(per_address) {}

  // False when that would be too many; else leave() follows. The empty address is held to the limit in all only.
  bool enter(const std::string& address);
  void leave(const std::string& address);
  int count() const { return count_; }

 private:
  const int in_all_, per_address_;
  int count_ = 0;
  std::map<std::string, int> counts_;  // at most in_all_ entries
};

// How many of something each token has open, within its share (shares.h).
class ShareCount {
 public:
  explicit ShareCount(const Share& share) : share_(share) {}

  // Gives itself back when it goes; the count outlives it.
  class Place {
   public:
    Place(ShareCount& count, std::string token_id) : count_(count), token_id_(std::move(token_id)) {}
    ~Place() { count_.leave(token_id_); }
    Place(const Place&) = delete;
    Place& operator=(const Place&) = delete;

   private:
    ShareCount& count_;
    const std::string token_id_;
  };

  // kBusy, in words with `things`.
  Result<std::unique_ptr<Place>> enter(const std::string& token_id, bool is_admin, const std::string& things);

 private:
  void leave(const std::string& token_id);

  const Share share_;
  std::int64_t count_ = 0;
  std::map<std::string, std::int64_t> counts_;  // of tokens that have some
};

}  // namespace hermite
